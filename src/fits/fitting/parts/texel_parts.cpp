#include "fitting/parts/texel_parts.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.h"
#include "base/wording.h"
#include "fitting/solvers/solver.h"
#include "geometry/mesh_part.h"

namespace radiafit::fits {
namespace {

Vec3f middle(const Mesh& mesh, uint32_t triangle) {
    const auto& [a, b, c] = mesh.triangles[triangle];
    return (mesh.positions[a] + mesh.positions[b] + mesh.positions[c]) / 3;
}

}  // namespace

DividedTexels::DividedTexels(const Dataset& dataset, const FitRequest& request, std::unique_ptr<Atlas> atlas,
                             size_t parameters)
    : dataset_(&dataset),
      request_(request),
      views_(fitted_views(dataset, request)),
      atlas_(std::move(atlas)),
      numbers_(parameters),
      mesh_(std::shared_ptr<const Mesh>(), &dataset.mesh) {
    per_place_ = dataset.has_grid() ? uint32_t(dataset.grid.width) : atlas_->texels_per_tile();
    for (uint32_t place = 0; place < atlas_->texel_count() / per_place_; ++place) {
        places_.push_back(dataset.has_grid() ? dataset.grid.position(0, int(place)).cast<float>()
                                             : middle(dataset.mesh, place));
        weights_.push_back(per_place_);
    }
}

Part DividedTexels::cut(std::span<const uint32_t> places) const {
    std::vector<uint32_t> units;
    for (const uint32_t place : places)
        for (uint32_t texel = place * per_place_; texel < (place + 1) * per_place_; ++texel) units.push_back(texel);
    const FitRequest request = part_request(request_, units);
    if (!dataset_->has_grid()) return {mesh_part(places, units), request, std::move(units)};
    Dataset part = part_dataset(*dataset_, {}, views_);
    part.grid = dataset_->grid;
    part.grid.texel_normals.assign(atlas_->texel_count(), Vec3f::Zero());
    for (const uint32_t texel : units)
        if (atlas_->usable(texel)) part.grid.texel_normals[texel] = atlas_->normal(texel);
    return {std::move(part), request, std::move(units)};
}

Dataset DividedTexels::mesh_part(std::span<const uint32_t> triangles, std::span<const uint32_t> texels) const {
    Dataset part = part_dataset(*dataset_, part_of(mesh_, {triangles.begin(), triangles.end()}), views_);
    part.normal_map.side = request_.model.surface_side;
    for (const uint32_t texel : texels) part.normal_map.normals.push_back(atlas_->normal(texel));
    return part;
}

PartResult DividedTexels::result_of(const Part& part, const FitRecord& fit, const std::vector<float>& all,
                                    std::string run_json) const {
    PartResult out;
    out.units = part.units;
    out.run_json = std::move(run_json);
    for (size_t i = 0; i < part.units.size(); ++i) {
        const size_t t = texel_in(part, i);
        const auto numbers = all.begin() + ptrdiff_t(t * numbers_);
        out.parameters.insert(out.parameters.end(), numbers, numbers + ptrdiff_t(numbers_));
        out.status.push_back(fit.status[t]);
        out.iterations.push_back(fit.iterations[t]);
        out.samples.push_back(fit.samples[t]);
        out.error.push_back(fit.error[t]);
    }
    return out;
}

uint64_t DividedTexels::held_bytes() const {
    const uint64_t triangles = dataset_->mesh.triangle_count(), vertices = dataset_->mesh.vertex_count();
    return vertices * (24 + 5) + triangles * (13 + 4) + places_.size() * 20 + dataset_->views.size() * 2 * sizeof(View);
}
uint64_t DividedTexels::result_bytes() const {
    return uint64_t(atlas_->texel_count()) * (numbers_ * sizeof(float) + 1 + 3 * 4);
}
uint64_t DividedTexels::merge_bytes(size_t parts) const {
    const uint64_t image = uint64_t(atlas_->width()) * uint64_t(atlas_->height()) * 4 * sizeof(float);
    constexpr uint64_t image_and_file = 2;
    return held_bytes() + result_bytes() + atlas_->texel_count() +
           std::max(result_bytes() / parts, image_and_file * image);
}

void DividedTexels::add(const PartResult& result, const std::string& name) {
    const size_t texels = atlas_->texel_count(), count = result.units.size();
    if (result.status.size() != count || result.parameters.size() != count * numbers_ ||
        (count > 0 && result.units.back() >= texels))
        throw_foreign(name);
    if (done_.empty()) {
        done_.resize(texels);
        parameters_.resize(texels * numbers_);
        problems_.status.resize(texels);
        problems_.iterations.resize(texels);
        problems_.samples.resize(texels);
        problems_.error.resize(texels);
    }
    for (size_t i = 0; i < count; ++i) {
        const size_t t = result.units[i];
        if (done_[t]++) throw UserError(fmt::format("{}: its texel {} was in another part too", name, t));
        std::copy_n(result.parameters.begin() + ptrdiff_t(i * numbers_), numbers_,
                    parameters_.begin() + ptrdiff_t(t * numbers_));
        problems_.status[t] = result.status[i];
        problems_.iterations[t] = result.iterations[i];
        problems_.samples[t] = result.samples[i];
        problems_.error[t] = result.error[i];
    }
    run_.add(result.run_json);
}

void DividedTexels::put_together(FitRecord& fit, std::vector<float>& all) {
    if (const auto missing = std::ranges::find(done_, 0); done_.empty() || missing != done_.end())
        throw UserError(fmt::format("texel {} is in no part; give all parts of the fit",
                                    done_.empty() ? 0 : missing - done_.begin()));
    fit.status = std::move(problems_.status);
    fit.iterations = std::move(problems_.iterations);
    fit.samples = std::move(problems_.samples);
    fit.error = std::move(problems_.error);
    all = std::move(parameters_);
    describe_request(request_, fit);
    set_dataset(fit, *dataset_);
}

}  // namespace radiafit::fits

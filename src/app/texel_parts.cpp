#include <fmt/format.h>

#include <algorithm>

#include "app/parts.h"
#include "app/solver.h"
#include "base/error.h"
#include "base/wording.h"
#include "geometry/mesh_part.h"

namespace radiafit {
namespace {

/// Units are texels; places are triangles, or rows of a grid.
class DividedTexels final : public Divided {
public:
    DividedTexels(const Dataset& dataset, const FitRequest& request)
        : dataset_(&dataset),
          request_(request),
          views_(fitted_views(dataset, request)),
          mesh_(std::shared_ptr<const Mesh>(), &dataset.mesh) {
        if (request.prior != PriorKind::none)
            throw UserError(fmt::format("{} is learned of the whole surface, in one piece; leave out it, or {} and {}",
                                        option_name("prior surface"), option_name("memory"), option_name("shard")));
        out_.atlas = texel_atlas(dataset, request.model.surface_side);
        const uint32_t texels = out_.atlas->texel_count();
        per_place_ = dataset.has_grid() ? uint32_t(dataset.grid.width) : out_.atlas->texels_per_tile();
        for (uint32_t place = 0; place < texels / per_place_; ++place) {
            places_.push_back(dataset.has_grid() ? dataset.grid.position(0, int(place)).cast<float>() : middle(place));
            weights_.push_back(per_place_);
        }
        out_.fit.parameters.resize(size_t(texels) * size_t(request.texel_model()->parameters));
        out_.fit.status.resize(texels);
        out_.fit.iterations.resize(texels);
        out_.fit.samples.resize(texels);
        out_.fit.error.resize(texels);
        done_.resize(texels);
    }

    std::span<const Vec3f> places() const override { return places_; }
    std::span<const uint64_t> weights() const override { return weights_; }

    Part cut(std::span<const uint32_t> places) const override {
        std::vector<uint32_t> units;
        for (const uint32_t place : places)
            for (uint32_t texel = place * per_place_; texel < (place + 1) * per_place_; ++texel) units.push_back(texel);
        const FitRequest request = part_request(request_, units);
        if (!dataset_->has_grid()) return {mesh_part(places, units), request, std::move(units)};
        Dataset part = part_dataset(*dataset_, {}, views_);
        part.grid = dataset_->grid;
        part.grid.texel_normals.assign(done_.size(), Vec3f::Zero());
        for (const uint32_t texel : units)
            if (out_.atlas->usable(texel)) part.grid.texel_normals[texel] = out_.atlas->normal(texel);
        return {std::move(part), request, std::move(units)};
    }

    PartResult solve(const Part& part) const override {
        const ReflectanceOutcome outcome = solve_reflectance(part.dataset, part.request);
        const ReflectanceFit& fit = outcome.fit;
        const size_t n = size_t(request_.texel_model()->parameters);
        PartResult out;
        out.units = part.units;
        out.run_json = run_to_json(outcome, {}, outcome.samples);
        for (size_t i = 0; i < part.units.size(); ++i) {
            const size_t t = dataset_->has_grid() ? part.units[i] : i;
            out.parameters.insert(out.parameters.end(), &fit.parameters[t * n], &fit.parameters[t * n] + n);
            out.status.push_back(fit.status[t]);
            out.iterations.push_back(fit.iterations[t]);
            out.samples.push_back(fit.samples[t]);
            out.error.push_back(fit.error[t]);
        }
        return out;
    }

    uint64_t held_bytes() const override {
        const uint64_t triangles = dataset_->mesh.triangle_count(), vertices = dataset_->mesh.vertex_count();
        const FitRecord& fit = out_.fit;
        return vertices * (24 + 5) + triangles * (13 + 4) + places_.size() * 20 + out_.fit.parameters.size() * 4 +
               fit.status.size() * (1 + 3 * 4 + 1) + dataset_->views.size() * 2 * sizeof(View);
    }
    uint64_t merge_bytes(size_t parts) const override {
        const uint64_t image = uint64_t(out_.atlas->width()) * uint64_t(out_.atlas->height()) * 4 * sizeof(float);
        constexpr uint64_t image_and_file = 2;
        return held_bytes() + std::max(out_.fit.parameters.size() * sizeof(float) / parts, image_and_file * image);
    }

    void add(const PartResult& result, const std::string& name) override {
        const size_t n = size_t(request_.texel_model()->parameters), count = result.units.size();
        if (result.status.size() != count || result.parameters.size() != count * n ||
            (count > 0 && result.units.back() >= done_.size()))
            throw UserError(name + ": of another fit; leave it out, or make it anew");
        for (size_t i = 0; i < count; ++i) {
            const size_t t = result.units[i];
            if (done_[t]++) throw UserError(fmt::format("{}: its texel {} was in another part too", name, t));
            std::copy_n(&result.parameters[i * n], n, &out_.fit.parameters[t * n]);
            out_.fit.status[t] = result.status[i];
            out_.fit.iterations[t] = result.iterations[i];
            out_.fit.samples[t] = result.samples[i];
            out_.fit.error[t] = result.error[i];
        }
        run_.add(result.run_json);
    }

    FinishedFit finish() override {
        if (const auto missing = std::ranges::find(done_, 0); missing != done_.end())
            throw UserError(fmt::format("texel {} is in no part; give all parts of the fit", missing - done_.begin()));
        static_cast<FitRun&>(out_) = run_.run();
        out_.samples = run_.samples();
        out_.fit.options = request_.texel_options();
        describe_request(request_, out_.fit);
        set_dataset(out_.fit, *dataset_);
        return finished_reflectance(std::move(out_), *dataset_);
    }

private:
    Vec3f middle(uint32_t triangle) const {
        const auto& [a, b, c] = dataset_->mesh.triangles[triangle];
        return (dataset_->mesh.positions[a] + dataset_->mesh.positions[b] + dataset_->mesh.positions[c]) / 3;
    }
    /// With the whole's normals: at the rim, the part's own would be others.
    Dataset mesh_part(std::span<const uint32_t> triangles, std::span<const uint32_t> texels) const {
        Dataset part = part_dataset(*dataset_, part_of(mesh_, {triangles.begin(), triangles.end()}), views_);
        part.normal_map.side = request_.model.surface_side;
        for (const uint32_t texel : texels) part.normal_map.normals.push_back(out_.atlas->normal(texel));
        return part;
    }

    const Dataset* dataset_;
    FitRequest request_;
    std::vector<uint32_t> views_;
    std::shared_ptr<const Mesh> mesh_;
    uint32_t per_place_ = 0;  ///< texels
    std::vector<Vec3f> places_;
    std::vector<uint64_t> weights_;
    std::vector<uint8_t> done_;  ///< [texels]
    ReflectanceOutcome out_;
    RunSum run_;
};

}  // namespace

std::unique_ptr<Divided> divide_texels(const Dataset& dataset, const FitRequest& asked) {
    asked.check();
    require_lights(dataset);
    FitRequest request = asked;
    request.space = TargetSpace::linear;  // the only one that reflectance has
    return std::make_unique<DividedTexels>(dataset, request);
}

}  // namespace radiafit

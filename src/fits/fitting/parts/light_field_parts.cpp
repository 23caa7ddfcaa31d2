#include <fmt/format.h>

#include <algorithm>

#include "base/error.h"
#include "base/log.h"
#include "base/parallel.h"
#include "fit/fit_maps.h"
#include "fitting/parts/parts.h"
#include "fitting/solvers/solver.h"
#include "geometry/mesh_part.h"

namespace radiafit::fits {
namespace {

/// Units and places are vertices.
class DividedLightField final : public Divided {
public:
    DividedLightField(const Dataset& dataset, const FitRequest& asked)
        : dataset_(&dataset),
          views_(fitted_views(dataset, asked)),
          asked_(asked),
          request_(with_sides(asked, dataset, views_)),
          mesh_(std::shared_ptr<const Mesh>(), &dataset.mesh),
          rings_(dataset.mesh),
          atlas_(surface_atlas(dataset.mesh, request_.model)) {
        const LfmLayout layout = layout_of(request_.model.view_side, request_.model.terms);
        for (size_t v = 0; v < rings_.vertex_count(); ++v) {
            weights_.push_back(layout.block_size(v));
            blocks_.push_back(layout.offset(v));
        }
    }

    std::span<const Vec3f> places() const override { return dataset_->mesh.positions; }
    std::span<const uint64_t> weights() const override { return weights_; }

    Part cut(std::span<const uint32_t> vertices) const override {
        Mesh mesh = part_around(mesh_, rings_, vertices, find_solver(request_.solver).halo);
        auto around = std::make_shared<Surroundings>(*mesh.surroundings);
        for (const uint32_t v : around->vertices) around->blocks.push_back(blocks_[v]);
        FitRequest request = request_;
        if (const TileSides& all = request_.model.sides) {
            auto sides = std::make_shared<std::vector<uint8_t>>();
            for (const uint32_t t : around->triangles) sides->push_back((*all)[t]);
            request.model.sides = sides;
        }
        mesh.surroundings = around;
        return {part_dataset(*dataset_, std::move(mesh), views_),
                part_request(request, vertices),
                {vertices.begin(), vertices.end()}};
    }

    PartResult solve(const Part& part) const override;
    uint64_t held_bytes() const override {
        const uint64_t vertices = rings_.vertex_count(), triangles = dataset_->mesh.triangle_count();
        // positions, normals, offsets, weights, blocks; triangles, corners, flags; the part's tables of all of them
        return vertices * (12 + 12 + 4 + 8 + 8) + triangles * (12 + 24 + 1) + vertices * 5 + triangles * 4 +
               dataset_->views.size() * 2 * sizeof(View);
    }
    uint64_t merge_bytes(size_t parts) const override {
        const LfmLayout layout = layout_of(request_.model.view_side, request_.model.terms);
        const uint64_t parameters = layout.size() * sizeof(float), problems = 3 * layout.problem_count() * 13;
        const uint64_t images = written_side_by_side(atlas_, layout) ? uint64_t(thread_count()) : 1;
        constexpr uint64_t image_and_file = 2;
        const uint64_t writing = images * image_and_file * largest_image_bytes(atlas_, layout);
        return held_bytes() + parameters + problems + std::max((parameters + problems) / parts, writing);
    }

    void add(const PartResult& result, const std::string& name) override {
        if (fit_.parameters.empty()) begin(result);
        const LfmLayout& layout = *layout_;
        size_t at = 0;
        const bool sized = result.status.size() == 3 * result.units.size() && result.terms == layout.terms() &&
                           result.view_side == layout.view_side() &&
                           (result.units.empty() || result.units.back() < layout.problem_count());
        if (sized)
            for (const uint32_t v : result.units) at += layout.block_size(v);
        if (!sized || at != result.parameters.size()) throw_foreign(name);
        at = 0;
        for (size_t i = 0; i < result.units.size(); ++i) {
            const size_t v = result.units[i];
            if (done_[v]++) throw UserError(fmt::format("{}: its vertex {} was in another part too", name, v));
            std::copy_n(&result.parameters[at], layout.block_size(v), &fit_.parameters[layout.offset(v)]);
            at += layout.block_size(v);
            for (size_t c = 0; c < 3; ++c) {
                fit_.status[3 * v + c] = result.status[3 * i + c];
                fit_.iterations[3 * v + c] = result.iterations[3 * i + c];
                fit_.samples[3 * v + c] = result.samples[3 * i + c];
                fit_.error[3 * v + c] = result.error[3 * i + c];
            }
        }
        run_.add(result.run_json);
    }

    FinishedFit finish(const EachPart&) override {
        if (const auto missing = std::ranges::find(done_, 0); done_.empty() || missing != done_.end())
            throw UserError(fmt::format("vertex {} is in no part; give all parts of the fit",
                                        done_.empty() ? 0 : missing - done_.begin()));
        fit_.options = request_.model_options();
        fit_.options.terms = layout_->terms();
        fit_.options.view_side = layout_->view_side();
        describe_request(asked_, fit_);
        set_dataset(fit_, *dataset_);
        return finished_light_field(std::move(fit_), run_.run(), run_.resampling(), *dataset_);
    }

private:
    LfmLayout layout_of(int view_side, int terms) const { return {rings_, atlas_, view_side, terms}; }
    void begin(const PartResult& first) {
        check_options([&] {
            LfmOptions options = request_.model;
            options.terms = first.terms;
            options.view_side = first.view_side;
            return options;
        }());
        layout_ = layout_of(first.view_side, first.terms);
        const size_t vertices = layout_->problem_count();
        fit_.parameters.resize(layout_->size());
        fit_.status.resize(3 * vertices);
        fit_.iterations.resize(3 * vertices);
        fit_.samples.resize(3 * vertices);
        fit_.error.resize(3 * vertices);
        done_.resize(vertices);
    }

    const Dataset* dataset_;
    std::vector<uint32_t> views_;
    FitRequest asked_, request_;  ///< request_: sides chosen
    std::shared_ptr<const Mesh> mesh_;
    VertexRings rings_;
    TriangleAtlas atlas_;
    std::vector<uint64_t> weights_, blocks_;  ///< [vertices]
    std::optional<LfmLayout> layout_;         ///< of what is put together
    std::vector<uint8_t> done_;               ///< [vertices]
    LightFieldFit fit_;
    RunSum run_;
};

PartResult DividedLightField::solve(const Part& part) const {
    const FitOutcome outcome = fits::solve(part.dataset, part.request);
    const LightFieldFit& fit = outcome.fit;
    const Mesh& mesh = part.dataset.mesh;
    const LfmLayout layout(VertexRings(mesh), surface_atlas(mesh, part.request.model), fit.options.view_side,
                           fit.options.terms);
    PartResult out;
    out.units = part.units;
    out.terms = fit.options.terms;
    out.view_side = fit.options.view_side;
    out.run_json = run_to_json(outcome, outcome.resampling);
    for (size_t v = 0; v < mesh.vertex_count(); ++v) {
        if (mesh.surroundings->rim[v]) continue;
        const auto block = fit.parameters.begin() + ptrdiff_t(layout.offset(v));
        out.parameters.insert(out.parameters.end(), block, block + ptrdiff_t(layout.block_size(v)));
        for (size_t i = 3 * v; i < 3 * v + 3; ++i) {
            out.status.push_back(fit.status[i]);
            out.iterations.push_back(fit.iterations[i]);
            out.samples.push_back(fit.samples[i]);
            out.error.push_back(fit.error[i]);
        }
    }
    return out;
}

}  // namespace

std::unique_ptr<Divided> divide_light_field(const Dataset& dataset, const FitRequest& request) {
    request.check();
    require_light_field(dataset);
    return std::make_unique<DividedLightField>(dataset, request);
}

}  // namespace radiafit::fits

#pragma once
#include "fitting/families/fitted_by_view.h"
#include "fitting/parts/texel_parts.h"

namespace radiafit::fits {

/// What all texels have in common is found once, from the whole surface and few of its samples; parts go on from there.
template <class Model>
class DividedByView final : public DividedTexels {
public:
    using Fit = typename Model::Fit;
    DividedByView(const Dataset& dataset, const FitRequest& request)
        : DividedTexels(dataset, request, by_view_atlas(dataset, request), Model::numbers(request)) {}

    PartResult solve(const Part& part) const override {
        Stopwatch clock;
        FitRun run;
        if (!begun_) begin(run);
        Fit fit = *begun_;
        const auto atlas = by_view_atlas(part.dataset, part.request);
        const Stopwatch distributing;
        const SampleList samples =
            interpolated_samples(part.dataset, *atlas, fitted_views(part.dataset, part.request), part.request.space);
        run.times.distribution += distributing.wall_s();
        const Stopwatch solving;
        Model::solve(part.dataset, *atlas, samples, part.request, fit, run);
        run.times.optimization += solving.wall_s();
        run.times.total = clock.wall_s();
        PartResult out = result_of(part, fit, fit.parameters, run_to_json(run, {}));
        Model::keep(fit, out);
        return out;
    }
    uint64_t learning_bytes(size_t most_views) const override {
        const uint64_t texels = Model::most_looked_at(request_);
        if (texels == 0) return 0;
        std::vector<PlanRow> rows = Model::working(triangles(), request_);
        std::erase_if(rows, [](const PlanRow& row) { return !(row.stages & PlanRow::while_learning); });
        add_samples_of_some(*dataset_, triangles(), request_, most_views, texels, rows);
        return total_bytes(rows);
    }
    uint64_t held_bytes() const override { return DividedTexels::held_bytes() + Model::common(request_).bytes; }

    void add(const PartResult& result, const std::string& name) override {
        DividedTexels::add(result, name);
        try {
            Model::take(result, whole_);
        } catch (const std::exception&) {
            throw_foreign(name);
        }
    }
    FinishedFit finish(const EachPart&) override {
        put_together(whole_, whole_.parameters);
        whole_.surface_side = request_.model.surface_side;
        Model::complete(triangles(), whole_);
        FinishedFit out;
        out.run = run_.run();
        out.fit = {FittedByView<Fit>{std::move(whole_), std::make_unique<TriangleAtlas>(triangles())}, *dataset_};
        return out;
    }

private:
    const TriangleAtlas& triangles() const { return static_cast<const TriangleAtlas&>(*atlas_); }
    void begin(FitRun& run) const {
        const Stopwatch clock;
        SampleList samples;
        if (const std::vector<bool> texels = Model::looked_at(triangles(), request_); !texels.empty())
            samples = interpolated_samples(*dataset_, triangles(), views_, request_.space, &texels);
        run.times.distribution += clock.wall_s();
        const Stopwatch learning;
        FinishedFit ignored;
        begun_.emplace();
        begun_->surface_side = request_.model.surface_side;
        Model::begin(*dataset_, triangles(), samples, request_, *begun_, ignored);
        run.times.optimization += learning.wall_s();
    }

    mutable std::optional<Fit> begun_;
    Fit whole_;  ///< of parts that were added
};

template <class Model>
std::unique_ptr<Divided> divide_by_view(const Dataset& dataset, const FitRequest& request) {
    request.check();
    require_light_field(dataset);
    return std::make_unique<DividedByView<Model>>(dataset, request);
}

/// What all these families do alike; the rest is left open.
template <class Model>
Family family_by_view() {
    Family family{};
    family.kind = ModelKind::by_view;
    family.owns = [](const std::string& model) { return model == Model::name; };
    family.models = [] { return std::vector<std::string>{Model::name}; };
    family.streamed = [](const FitRequest& request) -> std::optional<TargetSpace> { return request.space; };
    family.plan = plan_of_model<Model>;
    family.fit = fit_by_view<Model>;
    family.divide = divide_by_view<Model>;
    family.export_problems = [](const Dataset&, const FitRequest&, ProblemFolder&) { refuse_export<Model>(); };
    family.open = [](const std::filesystem::path& folder, const std::filesystem::path& moved_to) {
        auto stored = Model::read(folder, moved_to);
        return Fitted{FittedByView<typename Model::Fit>{std::move(stored.fit), std::move(stored.atlas)},
                      std::move(stored.dataset)};
    };
    return family;
}

}  // namespace radiafit::fits

#pragma once
#include <fmt/format.h>

#include "base/clock.h"
#include "base/error.h"
#include "base/wording.h"
#include "fitting/family.h"
#include "fitting/option_rows.h"
#include "fitting/parts/part_result.h"
#include "fitting/solvers/solver.h"
#include "samples/interpolated_samples.h"

/// What the families of colours by view direction, texel by texel, have in common. `Model` says what is special to one:
///
///     using Fit = ...;                     // a FitRecord with surface_side and parameters in a TriangleAtlas, with
///                                          // write_fit() and contestant_of()
///     static constexpr const char* name;   // of the model in requests
///     static constexpr auto read = ...;    // of a fit's folder: fit, atlas and dataset
///     static constexpr const char* have;   // "a view basis has"
///     static size_t numbers(const FitRequest&);  // of a texel
///
///     /// Fills what all texels have in common, and reports it in `out`. It may look at samples of those texels alone
///     /// that looked_at() names, which is empty where it looks at none.
///     static std::vector<bool> looked_at(const TriangleAtlas&, const FitRequest&);
///     static void begin(const Dataset&, const TriangleAtlas&, const SampleList&, const FitRequest&, Fit&,
///                       FinishedFit& out);
///     /// Of a fit as begin() left it, the problems and the parameters, texel by texel.
///     static void solve(const Dataset&, const TriangleAtlas&, const SampleList&, const FitRequest&, Fit&, FitRun&);
///
///     /// keep() stores what else a part has (PartResult::own); take() puts that into the whole's fit, part by part;
///     /// complete() does what is left when all are there. take() may throw std::exception for a part of another fit.
///     static void keep(const Fit& part, PartResult& out);
///     static void take(const PartResult& part, Fit& whole);
///     static void complete(const TriangleAtlas&, Fit& whole);
///
///     /// For plans: common(): what all texels have in common, no bytes if that is nothing; most_looked_at(): of how
///     /// many texels, at most, begin() looks at samples; working(): what else begin() and solve() hold.
///     static PlanRow common(const FitRequest&);
///     static uint64_t most_looked_at(const FitRequest&);
///     static std::vector<PlanRow> working(const TriangleAtlas&, const FitRequest&);
namespace radiafit::fits {

template <class Model>
[[noreturn]] void refuse_export() {
    throw UserError(fmt::format("{} no problems to export; choose lfm or a texel-local model", Model::have));
}

/// The atlas of the whole surface, or of a part with the whole's normals.
std::unique_ptr<TriangleAtlas> by_view_atlas(const Dataset& dataset, const FitRequest& request);

template <class Model>
FinishedFit fit_by_view(const Dataset& dataset, const FitRequest& request) {
    request.check();
    require_light_field(dataset);
    const Stopwatch clock;
    FinishedFit out;
    typename Model::Fit fit;
    fit.surface_side = request.model.surface_side;
    auto atlas = by_view_atlas(dataset, request);
    const SampleList samples = interpolated_samples(dataset, *atlas, fitted_views(dataset, request), request.space);
    require_seen(!samples.samples.empty(), dataset, request);
    out.run.times.distribution = clock.wall_s();
    const Stopwatch solving;
    Model::begin(dataset, *atlas, samples, request, fit, out);
    Model::solve(dataset, *atlas, samples, request, fit, out.run);
    out.run.times.optimization = solving.wall_s();
    describe_request(request, fit);
    set_dataset(fit, dataset);
    out.run.times.total = clock.wall_s();
    out.fit = {FittedByView<typename Model::Fit>{std::move(fit), std::move(atlas)}, dataset};
    return out;
}

/// Options that these families, and light bases, have in common.
struct ByViewOptions {
    double noise = 6e-4;  ///< variance of a residual, in units of white
    int blocks = 400;     ///< of the surface with a learned basis each, about so many
};
inline constexpr const char* by_view_group = "Learned bases and spherical Gaussians";
FitOption noise_option();
FitOption blocks_option();  ///< of learned bases
/// The rows, in their group.
std::vector<FitOption> by_view_options(std::vector<FitOption> rows);

/// Texels are independent: finer ones show more, as long as there are pixels for them. Colours are interpolated.
void resolve_by_view(const Given& given, const Dataset& dataset, FitRequest& request);
/// What a search tries of them.
Ladder noise_ladder();
Ladder side_ladder();

/// The plan for n numbers per texel and a row of what all texels have in common, without what else the model holds.
Plan plan_by_view(const Dataset& dataset, const FitRequest& request, size_t most_views, uint64_t n, PlanRow common);
template <class Model>
Plan plan_of_model(const Dataset& dataset, const FitRequest& request, size_t most_views) {
    Plan plan = plan_by_view(dataset, request, most_views, Model::numbers(request), Model::common(request));
    for (PlanRow& row : Model::working(*by_view_atlas(dataset, request), request))
        if (!request.part || row.stages != PlanRow::while_learning)  // the whole has learned it
            plan.memory.push_back(std::move(row));
    return plan;
}
/// Adds rows for while only `texels` of the atlas's texels are looked at: their samples, and what finds them.
void add_samples_of_some(const Dataset& dataset, const TriangleAtlas& atlas, const FitRequest& request,
                         size_t most_views, uint64_t texels, std::vector<PlanRow>& rows);

}  // namespace radiafit::fits

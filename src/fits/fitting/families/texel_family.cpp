#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "cpu/texel_fit.h"
#include "fitting/family.h"
#include "fitting/fit_options.h"
#include "fitting/solvers/solver.h"
#include "ownmodel/own_model.h"

namespace radiafit::fits {
namespace {

namespace fs = std::filesystem;

FinishedFit fit_reflectance(const Dataset& dataset, const FitRequest& request) {
    return finished_reflectance(solve_reflectance(dataset, request), dataset);
}

/// Levenberg-Marquardt where it can, and a side for the texels: that of the mesh's normals.
void resolve_texel_options(const Given& given, const Dataset& dataset, FitRequest& request) {
    if (facts_of(request).has_normal_equations() && !given("--optimizer") && !request.model.loss.robust())
        request.optimizer = nullptr;
    if (request.levenberg_marquardt() && !given("--iterations")) request.iterations = TexelFitOptions().iterations;
    if (!given("--prior") && facts_of(request).has_prior()) request.prior = PriorKind::surface;
    if (!given("--surface-side") && !dataset.has_grid()) request.model.surface_side = reflectance_side(dataset);
}

}  // namespace

int reflectance_side(const Dataset& dataset) {
    return dataset.normal_map.side > 0 ? dataset.normal_map.side : TexelOptions().surface_side;
}

FinishedFit finished_reflectance(ReflectanceOutcome outcome, const Dataset& dataset) {
    FinishedFit out;
    out.times_json = nlohmann::json{{"samples", outcome.samples}}.dump();
    out.note = fmt::format("{} texels, {} underdetermined, ", outcome.fit.problem_count(),
                           outcome.fit.status_counts()[size_t(Status::underdetermined)]);
    out.run = static_cast<FitRun&>(outcome);
    out.fit = {FittedReflectance{std::move(outcome.fit), std::move(outcome.atlas)}, dataset};
    return out;
}

const Family texel_local_models = {
    .name = "texel-local models",
    .owns = [](const std::string& model) { return model != lfm_name; },  // unknown names, too: reading one reports it
    .models =
        [] {
            std::vector<std::string> names;
            for (const TexelModel* model : texel_models()) names.push_back(model->name);
            return names;
        },
    .help = "the others are texel-local models, of datasets with lamps",
    .has_error_bars = true,
    .kind = ModelKind::texel_local,
    .facts = [](const Solver& solver) { return solver.texel_facts; },
    .streamed = [](const FitRequest& request) -> std::optional<TargetSpace> {
        if (request.on_fragment_engine()) return TargetSpace::linear;
        return std::nullopt;
    },
    .choose = choose_texel_model,
    .resolve_options = resolve_texel_options,
    .candidates = texel_candidates,
    .plan = plan_texels,
    .fit = fit_reflectance,
    .divide = divide_texels,
    .export_problems = export_texel_problems,
    .open =
        [](const fs::path& folder, const fs::path& moved_to) {
            load_model_of_fit(folder, fitted_model(folder), false);
            StoredReflectance stored = read_reflectance(folder, moved_to);
            return Fitted{FittedReflectance{std::move(stored.fit), std::move(stored.atlas)}, std::move(stored.dataset)};
        },
};

}  // namespace radiafit::fits

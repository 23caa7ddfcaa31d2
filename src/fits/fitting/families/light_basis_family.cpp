#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/choose.h"
#include "base/clock.h"
#include "base/error.h"
#include "fitting/families/fit_lamp_texels.h"
#include "fitting/families/fitted_by_view.h"
#include "fitting/plan/plan_rows.h"
#include "fitting/resolve_options.h"
#include "fitting/solvers/solver.h"

namespace radiafit::fits {
namespace {

FinishedFit fit_light_basis(const Dataset& dataset, const FitRequest& asked) {
    asked.check();
    require_lit(dataset);
    FitRequest request = asked;
    request.space = TargetSpace::linear;  // the only one that light bases have
    const Stopwatch clock;
    FinishedFit out;
    auto atlas = texel_atlas(dataset, request.model.surface_side);
    const std::vector<uint32_t> views = fitted_views(dataset, request);
    const SharedTexels samples = distribute_texels(dataset, request, views);
    require_seen(samples.source->sample_count() > 0, dataset, request);
    out.run.times.distribution = samples.seconds;
    const Stopwatch optimizing;
    double learning_s = 0;
    LightBasisFit fit = fit_lamp_texels(dataset, *atlas, views, samples, request, &out.run, &learning_s);
    out.times_json = nlohmann::json{{"learning_s", learning_s}}.dump();
    out.note = fmt::format("basis learned in {:.1f} s, ", learning_s);
    out.run.times.optimization = optimizing.wall_s();
    describe_request(request, fit);
    set_dataset(fit, dataset);
    out.run.times.total = clock.wall_s();
    out.fit = {FittedLightBasis{std::move(fit), std::move(atlas)}, dataset};
    return out;
}

Plan plan_light_basis(const Dataset& dataset, const FitRequest& request, size_t most_views) {
    request.check();
    require_lights(dataset);
    const LightBasisOptions options = light_basis_options(request);
    const auto atlas = texel_atlas(dataset, request.model.surface_side);
    const uint64_t texels = atlas->texel_count(), n = light_basis_numbers(request),
                   basis = uint64_t(options.blocks) * 3 * most_reference_lamps * uint64_t(options.rank + 1);
    Plan plan;
    plan.disk.push_back(
        {"maps",
         fmt::format("{} x {} pixels x {} floats, before they are compressed", atlas->width(), atlas->height(), n + 4),
         n + 4, uint64_t(atlas->width()) * uint64_t(atlas->height()) * 4 * (n + 4)});
    plan.disk.push_back(
        {"basis, about",
         fmt::format("{} blocks x {} floats at most", options.blocks, 3 * most_reference_lamps * (options.rank + 1)),
         basis, basis * sizeof(float)});
    std::vector<PlanRow>& rows = plan.memory;
    rows.push_back(plan.disk.back());
    const uint64_t samples = estimate_samples(dataset, *atlas, request, most_views).samples;
    rows.push_back({"samples, about", fmt::format("pixels in texels x {} bytes", sizeof(TexelRadiance)), samples,
                    samples * sizeof(TexelRadiance)});
    rows.push_back({"results", fmt::format("{} texels x ({} parameters, 4 figures)", texels, n), texels * n,
                    texels * 4 * (n + 4)});
    if (request.on_engine(EngineKind::compute))
        rows.push_back({"texels for the device", "some at a time, there and here", 1, bytes_on_device()});
    return plan;
}

void check_underneath(const std::string& name) {
    std::vector<std::string> names = {no_model};
    for (const TexelModel* model : texel_models()) names.emplace_back(model->name);
    if (std::ranges::find(names, name) == names.end()) reject_name("underneath", name, names);
}

}  // namespace

const Family light_bases = {
    .name = "light bases",
    .owns = [](const std::string& model) { return model == light_basis_name; },
    .models = [] { return std::vector<std::string>{light_basis_name}; },
    .help = "lightbasis is colours by lamp direction in each texel, on a basis that is learned over the surface",
    .options =
        [] {
            return by_view_options(
                {rows::number("numbers", 0, rows::own(&LightBasisOptions::rank), limits::light_rank,
                              "of each texel: functions of the lamp's direction, and the camera's where it moves"),
                 rows::text("underneath", 0, rows::own(&LightBasisOptions::underneath), "none, or a texel-local model",
                            "what the basis adds to: a reflectance model that is fitted first", check_underneath),
                 noise_option(), blocks_option()});
        },
    .has_error_bars = true,
    .kind = ModelKind::by_light,
    .facts = [](const Solver& solver) -> std::optional<SolverFacts> {
        if (solver.solve == solve_stream) return SolverFacts{.on_engine = true};
        return {};
    },
    .streamed = [](const FitRequest&) -> std::optional<TargetSpace> { return std::nullopt; },
    .choose = [](const Given&, const Dataset&, const FitRequest&) -> std::optional<Chosen> { return {}; },
    .resolve_options =
        [](const Given& given, const Dataset& dataset, FitRequest& request) {
            if (!given("--surface-side") && !dataset.has_grid()) request.model.surface_side = reflectance_side(dataset);
            if (!given("--numbers")) {  // further ones would be 0
                int& numbers = request.own<LightBasisOptions>().rank;
                numbers = std::min(numbers, 3 * int(fitted_views(dataset, request).size()));
            }
            if (!given("--noise")) request.own<ByViewOptions>().noise = LightBasisOptions().noise;
            if (!given("--blocks"))
                request.own<ByViewOptions>().blocks = light_blocks(*texel_atlas(dataset, request.model.surface_side));
        },
    .candidates = [](const Dataset& dataset) -> std::vector<TuneCandidate> {
        if (!dataset.light_moves() || !lamps_have_all_colours(dataset)) return {};
        return {{{{{"model", light_basis_name}}, {{"model", light_basis_name}, {"blocks", "64"}}},
                 {{"numbers", {"9", "18", "27", "54", "108"}},
                  {"curve", {"srgb", "root", "linear"}},
                  noise_ladder(),
                  {"blocks", {"1", "4", "16", "64"}}}}};
    },
    .plan = plan_light_basis,
    .fit = fit_light_basis,
    .divide = divide_light_basis,
    .export_problems =
        [](const Dataset&, const FitRequest&, ProblemFolder&) {
            throw UserError("a light basis has no problems to export; choose lfm or a texel-local model");
        },
    .open =
        [](const std::filesystem::path& folder, const std::filesystem::path& moved_to) {
            StoredLightBasis stored = read_light_basis(folder, moved_to);
            return Fitted{FittedLightBasis{std::move(stored.fit), std::move(stored.atlas)}, std::move(stored.dataset)};
        },
};

}  // namespace radiafit::fits

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/log.h"
#include "fitting/family.h"
#include "fitting/fit_options.h"
#include "fitting/solvers/solver.h"

namespace radiafit::fits {
namespace {

namespace fs = std::filesystem;

FinishedFit fit_light_field(const Dataset& dataset, const FitRequest& request) {
    FitOutcome outcome = solve(dataset, request);
    const ResamplingCounts resampling = outcome.resampling;
    FitRun run = outcome;
    return finished_light_field(std::move(outcome.fit), std::move(run), resampling, dataset);
}

/// What does well on captures and synthetic objects alike, beyond the paper's: few photographs show a vertex, and view
/// maps want to be smoother than surface maps.
void resolve_light_field_options(const Given& given, const Dataset&, FitRequest& request) {
    if (request.texels_per_pixel > 0 && given("--surface-side"))
        throw UserError("--texels-per-pixel chooses surface maps' sides; leave out --surface-side");
    if (request.mode == Mode::paper || !facts_of(request).objective) return;
    if (!given("--terms")) request.model.terms = 3;
    if (!given("--lambda-view")) request.model.lambda_view = 0.1f;
    // A pixel is a sample of what it covers, a texel's centre of every image alike: its share of pixels is the cosine.
    if (request.surface == SurfaceLookup::linear && facts_of(request).optimizer && !given("--weights"))
        request.model.loss.weights = SampleWeights::facing;
}

std::optional<Chosen> choose_light_field(const Given&, const Dataset& dataset, const FitRequest&) {
    if (dataset.light_moves()) return {};
    return Chosen{{{"model", lfm_name}}, nullptr};
}

std::vector<TuneCandidate> candidates(const Dataset& dataset) {
    if (dataset.light_moves()) return {};
    const FitSetting start = {{"model", lfm_name}, {"terms", "3"}, {"lambda_surface", "1e-3"}, {"lambda_view", "0.1"}};
    FitSetting robust = start;
    robust.emplace_back("loss", "huber");
    std::vector<Ladder> ladders = {{"terms", {"1", "2", "3", "4", "6"}},
                                   {"lambda_surface", {"1e-4", "3e-4", "1e-3", "3e-3", "1e-2"}},
                                   {"lambda_view", {"0.01", "0.03", "0.1", "0.3", "1"}},
                                   {"surface", {"nearest", "linear"}}};
    for (Ladder& ladder : loss_ladders()) ladders.push_back(std::move(ladder));
    return {{{start, robust}, std::move(ladders)}};
}

}  // namespace

FinishedFit finished_light_field(LightFieldFit fit, FitRun run, const ResamplingCounts& r, const Dataset& dataset) {
    FinishedFit out;
    if (r.entries) {
        out.times_json = nlohmann::ordered_json{{"resampling",
                                                 {{"entries", r.entries},
                                                  {"outside_hull", r.outside_hull},
                                                  {"unseen_texels", r.unseen_texels},
                                                  {"invented_share", r.invented_share()}}}}
                             .dump();
        out.note = fmt::format("{} of {} resampled entries ({:.1f}%) invented, ", r.outside_hull + r.unseen_texels,
                               r.entries, 100 * r.invented_share());
    }
    if (!run.accumulation.empty()) out.note += run.accumulation + "; ";
    out.fit = {FittedLightField{std::move(fit)}, dataset};
    out.run = std::move(run);
    return out;
}

const Family light_field_maps = {
    .name = "light field maps",
    .owns = [](const std::string& model) { return model == lfm_name; },
    .models = [] { return std::vector<std::string>{lfm_name}; },
    .help = "lfm is a light field map",
    .has_error_bars = true,
    .kind = ModelKind::light_field,
    .facts = [](const Solver& solver) { return solver.facts; },
    .streamed = [](const FitRequest& request) -> std::optional<TargetSpace> { return request.space; },
    .choose = choose_light_field,
    .resolve_options = resolve_light_field_options,
    .candidates = candidates,
    .plan = plan_light_field,
    .fit = fit_light_field,
    .divide = divide_light_field,
    .export_problems = export_light_field_problems,
    .open =
        [](const fs::path& folder, const fs::path& moved_to) {
            // The fit brings its mesh along: the dataset is looked at once it is wanted, or where it is said to be.
            Fitted out{FittedLightField{read_fit(folder).fit}, FittedDataset(moved_to)};
            if (!moved_to.empty()) out.dataset();
            return out;
        },
};

}  // namespace radiafit::fits

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "app/family.h"
#include "app/fit_options.h"
#include "base/error.h"
#include "base/log.h"
#include "publish/pages.h"

namespace radiafit {
namespace {

namespace fs = std::filesystem;

class FittedLightField : public Fitted {
public:
    FittedLightField(LightFieldFit fit, const Dataset& dataset) : fit_(std::move(fit)), dataset_(&dataset) {}
    /// The fit brings its mesh along: the dataset is looked at once it is wanted, or where it is said to be.
    FittedLightField(const fs::path& folder, const fs::path& moved_to)
        : fit_(read_fit(folder).fit), moved_to_(moved_to) {
        if (!moved_to.empty()) dataset();
    }

    FitRecord& record() override { return fit_; }
    const Dataset& dataset() override {
        if (!dataset_) {
            own_ = open_fitted_dataset(fit_, moved_to_);
            dataset_ = &*own_;
        }
        return *dataset_;
    }
    std::string description() const override {
        const LfmOptions& o = fit_.options;
        const int least = o.sides ? *std::ranges::min_element(*o.sides) : o.surface_side;
        const std::string side =
            o.sides ? fmt::format("sides {} to {}", least, o.surface_side) : fmt::format("side {}", o.surface_side);
        return fmt::format("{} terms, surface maps of {}, view maps of side {}", o.terms, side, o.view_side);
    }
    Contestant contestant() override { return contestant_of(fit_, dataset().mesh); }
    std::unique_ptr<Fitted> baseline() override { return mean_colours(dataset(), fit_, fit_.options); }
    const char* baseline_name() const override { return "mean colour per texel"; }
    PageModel page() override { return page_model_of(fit_, dataset().mesh); }
    void write(const fs::path& folder, const std::function<void(const fs::path&)>& add_files) override {
        write_fit(folder, fit_, dataset().mesh, add_files);
    }
    void export_parameters(ProblemFolder& out) override { radiafit::export_parameters(fit_, dataset().mesh, out); }

private:
    LightFieldFit fit_;
    fs::path moved_to_;
    std::optional<Dataset> own_;
    const Dataset* dataset_ = nullptr;
};

FinishedFit fit_light_field(const Dataset& dataset, const FitRequest& request) {
    FitOutcome outcome = solve(dataset, request);
    const ResamplingCounts resampling = outcome.resampling;
    FitRun run = outcome;
    return finished_light_field(std::move(outcome.fit), std::move(run), resampling, dataset);
}

/// What does well on captures and synthetic objects alike, beyond the paper's: few photographs show a vertex, and view
/// maps want to be smoother than surface maps.
void settle(const std::function<bool(const char*)>& given, const Dataset&, FitRequest& request) {
    if (request.texels_per_pixel > 0 && given("--surface-side"))
        throw UserError("--texels-per-pixel chooses surface maps' sides; leave out --surface-side");
    if (request.mode == Mode::paper || !(uses_of(request) & use::smoothness)) return;
    if (!given("--terms")) request.model.terms = 3;
    if (!given("--lambda-view")) request.model.lambda_view = 0.1f;
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
    out.fit = std::make_unique<FittedLightField>(std::move(fit), dataset);
    out.run = std::move(run);
    return out;
}

std::unique_ptr<Fitted> mean_colours(const Dataset& dataset, const FitRecord& like, const LfmOptions& sides) {
    FitRequest mean;
    mean.set("solver", "mean");
    mean.space = like.space;
    mean.model = sides;
    mean.validation = validation_of(like);
    return std::make_unique<FittedLightField>(solve(dataset, mean).fit, dataset);
}

const Family light_field_maps = {
    .name = "light field maps",
    .owns = [](const std::string& model) { return model == lfm_name; },
    .models = [] { return std::vector<std::string>{lfm_name}; },
    .help = "lfm is a light field map",
    .has_error_bars = false,
    .uses = [](const Solver& solver) { return solver.uses; },
    .streamed = [](const FitRequest& request) -> std::optional<TargetSpace> { return request.space; },
    .settle = settle,
    .plan = plan_light_field,
    .fit = fit_light_field,
    .divide = divide_light_field,
    .export_problems = export_light_field_problems,
    .open = [](const fs::path& folder, const fs::path& moved_to) -> std::unique_ptr<Fitted> {
        return std::make_unique<FittedLightField>(folder, moved_to);
    },
};

}  // namespace radiafit

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "app/family.h"
#include "app/fit_options.h"
#include "app/solver.h"
#include "base/error.h"
#include "base/log.h"
#include "cpu/vertex_covariance.h"
#include "exchange/surface_look.h"
#include "fit/error_bar_maps.h"
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
    Contestant contestant() override {
        Contestant out = contestant_of(fit_, dataset().mesh);
        if (error_bars_)
            out.error_bars = [this](const View& view, const auto& pixels, std::vector<ErrorBar>& bars) {
                tell_error_bars(view, pixels, bars);
            };
        return out;
    }
    void find_error_bars(std::span<const View> shown) override {
        const FitRequest fitted = fitted_request(fit_);
        LfmOptions options = fit_.options;
        options.loss = fitted.model.loss;
        if (!facts_of(fitted).objective) options.lambda_surface = options.lambda_view = options.mu = 0;
        atlas_.emplace(surface_atlas(dataset().mesh, options));
        FitRequest request;
        request.space = fit_.space;
        const SharedSamples samples = distribute(dataset(), *atlas_, request, fitted_views(dataset(), fit_));
        for (const View& view : shown) eyes_.push_back(view.camera.center());
        error_bars_.emplace(dataset(), *atlas_, VertexRings(dataset().mesh), samples.list, options, fit_.parameters,
                            eyes_);
    }
    void write_error_bars(const fs::path& folder) override {
        if (!error_bars_) return;
        radiafit::write_error_bars(folder, fit_, dataset().mesh,
                                   {error_bars_->deviation, error_bars_->noise, error_bars_->deficient});
    }
    std::unique_ptr<Fitted> baseline() override { return mean_colours(dataset(), fit_, fit_.options); }
    const char* baseline_name() const override { return "mean colour per texel"; }
    PageModel page() override { return page_model_of(fit_, dataset().mesh); }
    SurfaceLook look() override { return look_of(fit_, dataset(), fitted_views(dataset(), fit_)); }
    void write(const fs::path& folder, const std::function<void(const fs::path&)>& add_files) override {
        write_fit(folder, fit_, dataset().mesh, add_files);
    }
    std::vector<FitArray> arrays() override {
        const uint64_t terms = uint64_t(fit_.options.terms),
                       texel = 4 * terms;  // red, green, blue, and one lane of padding
        if (first_texels_.empty()) {
            const Mesh& mesh = dataset().mesh;
            const LfmLayout layout(VertexRings(mesh), surface_atlas(mesh, fit_.options), fit_.options.view_side,
                                   fit_.options.terms);
            for (size_t v = 0; v < layout.problem_count(); ++v) {
                first_texels_.push_back(int64_t(layout.offset(v) / texel));
                first_texels_.push_back(int64_t(layout.view_offset(v) / texel));
            }
        }
        return {
            FitArray::of(
                "texels",
                "texel, term, channel: of each vertex its surface maps, by the triangles around it, then its view map",
                fit_.parameters.data(), {fit_.parameters.size() / texel, terms, 3}, {texel, 4, 1}),
            FitArray::of("first_texels", "vertex: where its surface maps begin, and where its view map",
                         first_texels_.data(), {first_texels_.size() / 2, 2})};
    }
    void export_parameters(ProblemFolder& out) override { radiafit::export_parameters(fit_, dataset().mesh, out); }

private:
    void tell_error_bars(const View& view, const std::vector<RasterPixel>& pixels, std::vector<ErrorBar>& bars) const {
        const auto eye = std::ranges::find(eyes_, view.camera.center());
        if (eye == eyes_.end()) throw std::logic_error("error bars of a view that was not to be shown");
        bars.assign(pixels.size(), {});
        for (size_t i = 0; i < pixels.size(); ++i) {
            const RasterPixel& pixel = pixels[i];
            if (pixel.triangle == no_triangle) continue;
            const uint32_t local = atlas_->local_at(pixel.triangle, pixel.b1, pixel.b2);
            bars[i].fit = error_bars_->of_value(size_t(eye - eyes_.begin()), pixel.triangle, local);
            bars[i].noise = error_bars_->noise_at(pixel.triangle, local);
        }
    }

    LightFieldFit fit_;
    std::vector<int64_t> first_texels_;   ///< of arrays(), once it was called
    std::optional<TriangleAtlas> atlas_;  ///< with the error bars
    std::vector<Vec3d> eyes_;             ///< whose views these tell of
    std::optional<AllVertexErrorBars> error_bars_;
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
void settle(const Given& given, const Dataset&, FitRequest& request) {
    if (request.texels_per_pixel > 0 && given("--surface-side"))
        throw UserError("--texels-per-pixel chooses surface maps' sides; leave out --surface-side");
    if (request.mode == Mode::paper || !facts_of(request).objective) return;
    if (!given("--terms")) request.model.terms = 3;
    if (!given("--lambda-view")) request.model.lambda_view = 0.1f;
    // A pixel is a sample of what it covers, a texel's centre of every image alike: its share of pixels is the cosine.
    if (request.surface == SurfaceLookup::linear && facts_of(request).optimizer && !given("--weights"))
        request.model.loss.weights = SampleWeights::facing;
}

std::optional<Chosen> choose(const Given&, const Dataset& dataset) {
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
    out.fit = std::make_unique<FittedLightField>(std::move(fit), dataset);
    out.run = std::move(run);
    return out;
}

std::unique_ptr<Fitted> mean_colours(const Dataset& dataset, const FitRecord& like, const LfmOptions& sides) {
    FitRequest mean;
    mean.set("solver", "mean");
    mean.space = like.space;
    mean.surface = like.surface;
    mean.model = sides;
    mean.validation = validation_of(like);
    return std::make_unique<FittedLightField>(solve(dataset, mean).fit, dataset);
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
    .choose = choose,
    .settle = settle,
    .candidates = candidates,
    .plan = plan_light_field,
    .fit = fit_light_field,
    .divide = divide_light_field,
    .export_problems = export_light_field_problems,
    .open = [](const fs::path& folder, const fs::path& moved_to) -> std::unique_ptr<Fitted> {
        return std::make_unique<FittedLightField>(folder, moved_to);
    },
};

}  // namespace radiafit

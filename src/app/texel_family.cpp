#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "app/family.h"
#include "app/fit_options.h"
#include "app/solver.h"
#include "cpu/texel_covariance.h"
#include "cpu/texel_fit.h"
#include "dataset/texel_shading.h"
#include "dataset/truth.h"
#include "eval/reflectance_renderer.h"
#include "eval/render.h"
#include "eval/safe_relighting.h"
#include "eval/truth_errors.h"
#include "exchange/surface_look.h"
#include "fit/texel_fit.h"
#include "publish/pages.h"

namespace radiafit {
namespace {

namespace fs = std::filesystem;

class FittedReflectance : public Fitted {
public:
    FittedReflectance(ReflectanceOutcome outcome, const Dataset& dataset)
        : fit_(std::move(outcome.fit)), dataset_(&dataset), atlas_(std::move(outcome.atlas)) {}
    explicit FittedReflectance(StoredReflectance stored)
        : fit_(std::move(stored.fit)),
          own_(std::move(stored.dataset)),
          dataset_(own_.get()),
          atlas_(std::move(stored.atlas)) {}

    FitRecord& record() override { return fit_; }
    const Dataset& dataset() override { return *dataset_; }
    std::string description() const override {
        const TexelModel& model = *fit_.options.model;
        return fmt::format("{}, {} parameters in each of {} texels", model.name, model.parameters,
                           fit_.problem_count());
    }
    Contestant contestant() override {
        Contestant out = safe_contestant_of(fit_, *atlas_, dataset(), fitted_views(dataset(), fit_));
        if (error_bars_)
            out.error_bars = [this](const View& view, const auto& pixels, std::vector<ErrorBar>& bars) {
                tell_error_bars(view, pixels, bars);
            };
        return out;
    }
    void find_error_bars(std::span<const View>) override {
        const auto views = fitted_views(dataset(), fit_);
        TexelOptions options = fit_.options;
        options.loss = fitted_request(fit_).model.loss;
        FitRequest request;
        request.model.surface_side = fit_.options.surface_side;
        const SharedTexels samples = distribute_texels(dataset(), request, views);
        const TexelLoader loader(dataset(), *atlas_, views, options);
        error_bars_.emplace(TexelProblem{*samples.source, loader, options}, fit_.parameters);
    }
    void write_error_bars(const fs::path& folder) override {
        if (!error_bars_) return;
        radiafit::write_error_bars(folder, *atlas_, *fit_.options.model,
                                   {error_bars_->deviation, error_bars_->noise, error_bars_->deficient});
    }
    std::unique_ptr<Fitted> baseline() override {
        FitRequest diffuse;
        diffuse.set("model", "lambert").set("optimizer", "lm");
        diffuse.model.surface_side = fit_.options.surface_side;
        diffuse.clip_above = fit_.options.clip_above;
        diffuse.shadow_below = fit_.options.shadow_below;
        diffuse.validation = validation_of(fit_);
        return std::make_unique<FittedReflectance>(solve_reflectance(dataset(), diffuse), dataset());
    }
    const char* baseline_name() const override { return "Lambertian"; }
    SurfaceParts parts() override {
        SurfaceParts parts;
        if (!has_truth(dataset())) return parts;
        const auto truth = std::make_shared<ReflectanceTruth>(read_truth(dataset().folder));
        const auto renderer = std::make_shared<ReflectanceRenderer>(*atlas_, fit_);
        for (const TruthMaterial& material : truth->materials) parts.names.push_back(material.name);
        parts.of = [=](const RasterPixel& pixel) { return size_t(truth->material[renderer->texel_of(pixel)]); };
        return parts;
    }
    std::vector<MaterialErrors> truth_errors() override {
        if (!has_truth(dataset())) return {};
        return radiafit::truth_errors(fit_, read_truth(dataset().folder),
                                      error_bars_ ? error_bars_->deviation : std::vector<float>());
    }
    bool takes_light() const override { return true; }
    std::optional<ProblemPicture> problems() override {
        ProblemPicture picture;
        picture.width = atlas_->width();
        picture.height = atlas_->height();
        for (auto* map : {&picture.status, &picture.iterations, &picture.samples, &picture.rms})
            map->assign(size_t(picture.width) * size_t(picture.height), NAN);
        for (uint32_t t = 0; t < atlas_->texel_count(); ++t) {
            if (!atlas_->usable(t)) continue;
            const auto [x, y] = atlas_->place(t);
            const size_t at = size_t(y) * size_t(picture.width) + size_t(x);
            picture.status[at] = float(fit_.status[t]);
            picture.iterations[at] = float(fit_.iterations[t]);
            picture.samples[at] = float(fit_.samples[t]);
            if (fit_.samples[t] > 0) picture.rms[at] = std::sqrt(2 * fit_.error[t] / (3 * float(fit_.samples[t])));
        }
        for (size_t s = 0; s < size_t(Status::count); ++s) picture.status_names.push_back(to_string(Status(s)));
        picture.title = fmt::format("{}: {} by {} on {}, a problem per texel", fit_.dataset_name,
                                    fit_.options.model->name, fit_.solver, fit_.engine);
        picture.unit = "reflectance (white = 1)";
        picture.mark = picture_mark;
        return picture;
    }
    PageModel page() override { return page_model_of(fit_, *atlas_, dataset(), fitted_views(dataset(), fit_)); }
    SurfaceLook look() override { return look_of(fit_, *atlas_, dataset(), fitted_views(dataset(), fit_)); }
    void write(const fs::path& folder, const std::function<void(const fs::path&)>& add_files) override {
        write_fit(folder, fit_, *atlas_, add_files);
    }
    std::vector<FitArray> arrays() override {
        return {FitArray::of("texels", "texel, parameter", fit_.parameters.data(),
                             {fit_.problem_count(), uint64_t(fit_.options.model->parameters)})};
    }
    void export_parameters(ProblemFolder& out) override { radiafit::export_parameters(fit_, out); }

private:
    void tell_error_bars(const View& view, const std::vector<RasterPixel>& pixels, std::vector<ErrorBar>& bars) const {
        const ReflectanceRenderer renderer(*atlas_, fit_);
        const size_t n = size_t(fit_.options.model->parameters);
        bars.assign(pixels.size(), {});
        for (size_t i = 0; i < pixels.size(); ++i) {
            if (pixels[i].triangle == no_triangle) continue;
            const uint32_t texel = renderer.texel_of(pixels[i]);
            const TexelShading::Lit lit = TexelShading::lit(TexelShading::place(*atlas_, texel), view);
            const auto value = error_bars_->of_value(texel, {&fit_.parameters[texel * n], n}, lit.u, lit.v);
            bars[i].fit = Vec3f(value[0], value[1], value[2]).cwiseProduct(lit.irradiance);
            bars[i].noise = error_bars_->noise[texel] * lit.irradiance;
            if (error_bars_->noise[texel] == 0) bars[i].fit.setConstant(INFINITY);  // nothing is known of it
        }
    }

    ReflectanceFit fit_;
    std::optional<AllErrorBars> error_bars_;
    std::unique_ptr<Dataset> own_;
    const Dataset* dataset_;
    std::unique_ptr<Atlas> atlas_;
};

FinishedFit fit_reflectance(const Dataset& dataset, const FitRequest& request) {
    return finished_reflectance(solve_reflectance(dataset, request), dataset);
}

/// Levenberg-Marquardt where it can, and a side for the texels: that of the mesh's normals.
void settle(const Given& given, const Dataset& dataset, FitRequest& request) {
    if (facts_of(request).has_normal_equations() && !given("--optimizer") && !request.model.loss.robust())
        request.optimizer = nullptr;
    if (request.levenberg_marquardt() && !given("--iterations")) request.iterations = TexelFitOptions().iterations;
    if (!given("--prior") && facts_of(request).has_prior()) request.prior = PriorKind::surface;
    if (!given("--surface-side") && !dataset.has_grid())
        request.model.surface_side =
            dataset.normal_map.side > 0 ? dataset.normal_map.side : TexelOptions().surface_side;
}

}  // namespace

FinishedFit finished_reflectance(ReflectanceOutcome outcome, const Dataset& dataset) {
    FinishedFit out;
    out.times_json = nlohmann::json{{"samples", outcome.samples}}.dump();
    out.note = fmt::format("{} texels, {} underdetermined, ", outcome.fit.problem_count(),
                           outcome.fit.status_counts()[size_t(Status::underdetermined)]);
    out.run = static_cast<FitRun&>(outcome);
    out.fit = std::make_unique<FittedReflectance>(std::move(outcome), dataset);
    return out;
}

const Family texel_local_models = {
    .name = "texel-local models",
    .owns = [](const std::string& model) { return model != lfm_name; },  // those that are none are told by their reader
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
    .settle = settle,
    .candidates = texel_candidates,
    .plan = plan_texels,
    .fit = fit_reflectance,
    .divide = divide_texels,
    .export_problems = export_texel_problems,
    .open = [](const fs::path& folder, const fs::path& moved_to) -> std::unique_ptr<Fitted> {
        return std::make_unique<FittedReflectance>(read_reflectance(folder, moved_to));
    },
};

}  // namespace radiafit

// What a fitted texel-local model answers.
#include <fmt/format.h>

#include <cmath>

#include "cpu/texel_covariance.h"
#include "dataset/texel_shading.h"
#include "dataset/truth.h"
#include "eval/reflectance_renderer.h"
#include "eval/safe_relighting.h"
#include "eval/truth_errors.h"
#include "fit/error_bar_maps.h"
#include "fit/fit_maps.h"
#include "fit/texel_fit.h"
#include "fitting/families/fitted_models.h"
#include "fitting/family.h"
#include "fitting/solvers/solver.h"

namespace radiafit::fits {
namespace {

/// At the pixels of a view [height][width].
void show_error_bars(const FittedReflectance& m, const View& view, const std::vector<RasterPixel>& pixels,
                     std::vector<ErrorBar>& bars) {
    const ReflectanceRenderer renderer(*m.atlas, m.fit);
    const TexelModel& model = *m.fit.options.model;
    const size_t n = size_t(model.parameters);
    bars.assign(pixels.size(), {});
    for (size_t i = 0; i < pixels.size(); ++i) {
        if (pixels[i].triangle == no_triangle) continue;
        const uint32_t texel = renderer.texel_of(pixels[i]);
        const TexelShading::Lit lit = TexelShading::lit(TexelShading::place(*m.atlas, texel), view);
        const std::span<const float> p(&m.fit.parameters[texel * n], n);
        const auto value = model.value(p, lit.u, lit.v), deviation = m.error_bars->of_value(texel, p, lit.u, lit.v);
        const auto in_light = [&](const Vec3f& of_value) -> Vec3f {
            return deviation_of_light(m.fit.options.curve, Vec3f(value[0], value[1], value[2]), of_value)
                .cwiseProduct(lit.irradiance);
        };
        bars[i].fit = in_light({deviation[0], deviation[1], deviation[2]});
        bars[i].noise = in_light(Vec3f::Constant(m.error_bars->noise[texel]));
        if (m.error_bars->noise[texel] == 0) bars[i].fit.setConstant(INFINITY);  // nothing is known of it
    }
}

}  // namespace

std::string description_of(const FittedReflectance& m) {
    const TexelModel& model = *m.fit.options.model;
    return fmt::format("{}, {} parameters in each of {} texels", model.name, model.parameters, m.fit.problem_count());
}

Contestant contestant_of(const FittedReflectance& m, const Dataset& dataset) {
    Contestant out = safe_contestant_of(m.fit, *m.atlas, dataset, fitted_views(dataset, m.fit));
    if (m.error_bars)
        out.error_bars = [&m](const View& view, const auto& pixels, std::vector<ErrorBar>& bars) {
            show_error_bars(m, view, pixels, bars);
        };
    return out;
}

void find_error_bars(FittedReflectance& m, const Dataset& dataset, std::span<const View>) {
    const auto views = fitted_views(dataset, m.fit);
    TexelOptions options = m.fit.options;
    options.loss = fitted_request(m.fit).model.loss;
    FitRequest request;
    request.model.surface_side = m.fit.options.surface_side;
    const SharedTexels samples = distribute_texels(dataset, request, views);
    const TexelLoader loader(dataset, *m.atlas, views, options);
    m.error_bars = std::make_shared<AllErrorBars>(TexelProblem{*samples.source, loader, options}, m.fit.parameters);
}

void write_error_bars(const std::filesystem::path& folder, const FittedReflectance& m, const Dataset&) {
    if (!m.error_bars) return;
    write_error_bars(folder, *m.atlas, maps_of(*m.fit.options.model),
                     {m.error_bars->deviation, m.error_bars->noise, m.error_bars->deficient});
}

Fitted lambertian(const Dataset& dataset, int surface_side, int validation, float clip_above, float shadow_below) {
    FitRequest diffuse;
    diffuse.set("model", "lambert").set("optimizer", "lm");
    diffuse.model.surface_side = surface_side;
    diffuse.clip_above = clip_above;
    diffuse.shadow_below = shadow_below;
    diffuse.validation = validation;
    ReflectanceOutcome solved = solve_reflectance(dataset, diffuse);
    return {FittedReflectance{std::move(solved.fit), std::move(solved.atlas)}, dataset};
}

Fitted baseline_of(const FittedReflectance& m, const Dataset& dataset) {
    const TexelOptions& options = m.fit.options;
    return lambertian(dataset, options.surface_side, validation_of(m.fit), options.clip_above, options.shadow_below);
}

SurfaceParts surface_parts(const FittedReflectance& m, const Dataset& dataset) {
    SurfaceParts parts;
    if (!has_truth(dataset)) return parts;
    const auto truth = std::make_shared<ReflectanceTruth>(read_truth(dataset.folder));
    const auto renderer = std::make_shared<ReflectanceRenderer>(*m.atlas, m.fit);
    for (const TruthMaterial& material : truth->materials) parts.names.push_back(material.name);
    parts.of = [=](const RasterPixel& pixel) { return size_t(truth->material[renderer->texel_of(pixel)]); };
    return parts;
}

std::vector<MaterialErrors> truth_errors(const FittedReflectance& m, const Dataset& dataset) {
    if (!has_truth(dataset) || m.fit.options.curve != ValueCurve::linear) return {};
    return truth_errors(m.fit, read_truth(dataset.folder),
                        m.error_bars ? m.error_bars->deviation : std::vector<float>());
}

std::vector<FitArray> arrays_of(const FittedReflectance& m, const Dataset&) {
    return {FitArray::of("texels", "texel, parameter", m.fit.parameters.data(),
                         {m.fit.problem_count(), uint64_t(m.fit.options.model->parameters)})};
}

void export_parameters(const FittedReflectance& m, const Dataset&, ProblemFolder& out) {
    export_parameters(m.fit, out);
}

}  // namespace radiafit::fits

// What a fitted light basis answers.
#include <fmt/format.h>

#include <cmath>

#include "base/error.h"
#include "dataset/texel_shading.h"
#include "eval/texel_of_pixel.h"
#include "fitting/families/fit_lamp_texels.h"
#include "fitting/families/fitted_models.h"
#include "fitting/solvers/solver.h"

namespace radiafit::fits {
namespace {

/// At the pixels of a view [height][width], in linear light: what a standard deviation on the curve makes of the
/// colour.
void show_error_bars(const FittedLightBasis& m, const Contestant& colours, const InwardTurns& inward, const View& view,
                     const std::vector<RasterPixel>& pixels, std::vector<ErrorBar>& bars) {
    const TexelOfPixel texel_of(*m.atlas);
    const LightBasis& basis = m.fit.basis;
    LightBasisSolver solver(basis);
    std::vector<float> rgb;
    colours.shade(view, pixels, rgb, 0);
    bars.assign(pixels.size(), {});
    for (size_t i = 0; i < pixels.size(); ++i) {
        if (pixels[i].triangle == no_triangle) continue;
        const uint32_t texel = texel_of(pixels[i]);
        const Vec3f position = m.atlas->position(texel);
        const TexelShading::Place place{position.cast<double>(), basis.frame_of(m.atlas->normal(texel))};
        const TexelShading::Lit lit = TexelShading::lit(place, view);
        const Vec3f value = basis.value_of(Vec3f::Map(&rgb[3 * i]), lit.irradiance);
        const auto in_light = [&](const Vec3f& deviation) -> Vec3f {
            return (basis.light_of(value + deviation, lit.irradiance) -
                    basis.light_of(value - deviation, lit.irradiance)) /
                   2;
        };
        if (m.error_bars->noise[texel] == 0) {  // nothing is known of it
            bars[i].fit.setConstant(INFINITY);
            continue;
        }
        const LampAndHalf at =
            inward.turned(basis, place.frame, view.light->direction_from(place.position).cast<float>(),
                          view.direction_to_camera(place.position).cast<float>());
        bars[i].fit = in_light(m.error_bars->of_value(texel, basis.block_at(position), at, solver));
        bars[i].noise = in_light(Vec3f::Constant(m.error_bars->noise[texel]));
    }
}

}  // namespace

std::string description_of(const FittedLightBasis& m) {
    const LightBasis& basis = m.fit.basis;
    return fmt::format("light basis of rank {}{} in {} blocks of the surface{}, {} numbers in each of {} texels",
                       basis.rank, basis.by_half() ? " by lamp and half vector" : "", basis.cubes.size(),
                       m.fit.underneath ? fmt::format(" upon {}", m.fit.underneath->name) : "", m.fit.numbers(),
                       m.fit.problem_count());
}

Contestant contestant_of(const FittedLightBasis& m, const Dataset& dataset) {
    const std::vector<uint32_t> training = fitted_views(dataset, m.fit);
    Contestant out = contestant_of(m.fit, *m.atlas, dataset, training);
    if (m.error_bars)
        out.error_bars = [&m, &dataset, training, colours = out](const View& view, const auto& pixels,
                                                                 std::vector<ErrorBar>& bars) {
            show_error_bars(m, colours, turns_inside(dataset, training, view), view, pixels, bars);
        };
    return out;
}

void find_error_bars(FittedLightBasis& m, const Dataset& dataset, std::span<const View>) {
    const auto views = fitted_views(dataset, m.fit);
    FitRequest request;
    request.model.surface_side = m.fit.surface_side;
    const SharedTexels samples = distribute_texels(dataset, request, views);
    const Underneath underneath(dataset, *m.atlas, views, m.fit);
    const TexelLightReader reader(dataset, *m.atlas, views, m.fit.basis, underneath.light());
    m.error_bars = std::make_shared<LightErrorBars>(m.fit, *m.atlas, *samples.source, reader);
}

void write_error_bars(const std::filesystem::path& folder, const FittedLightBasis& m, const Dataset&) {
    if (m.error_bars) write_error_bars(folder, *m.atlas, m.fit, *m.error_bars);
}

Fitted baseline_of(const FittedLightBasis& m, const Dataset& dataset) {
    return lambertian(dataset, m.fit.surface_side, validation_of(m.fit));
}

std::vector<FitArray> arrays_of(const FittedLightBasis& m, const Dataset&) {
    return {FitArray::of("texels", "texel, function of the basis, then parameter of the model underneath",
                         m.fit.parameters.data(), {m.fit.problem_count(), uint64_t(m.fit.numbers())})};
}

void export_parameters(const FittedLightBasis&, const Dataset&, ProblemFolder&) {
    throw UserError("a light basis has no problems to export; choose lfm or a texel-local model");
}

}  // namespace radiafit::fits

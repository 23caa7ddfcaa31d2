#include "publish/uncertainty.h"

#include <algorithm>
#include <cmath>

#include "eval/texel_pixels.h"
#include "publish/choices.h"
#include "publish/page_model.h"

namespace radiafit::tools {
namespace {

constexpr size_t views_asked = 8;
constexpr float steps_of_scale = 250;

/// Only what faces camera and lamp.
void leave_out_hidden(const View& view, const Atlas& atlas, std::vector<RasterPixel>& pixels) {
    for (uint32_t t = 0; t < pixels.size(); ++t) {
        if (pixels[t].triangle == no_triangle) continue;
        const Vec3d place = atlas.position(t).cast<double>(), normal = atlas.normal(t).cast<double>();
        const bool lit = !view.light || view.light->direction_from(place).dot(normal) > 0;
        if (!lit || view.direction_to_camera(place).dot(normal) <= 0) pixels[t].triangle = no_triangle;
    }
}

}  // namespace

std::vector<uint32_t> uncertainty_views(const std::vector<uint32_t>& training) { return spread(training, views_asked); }

PageMap uncertainty_map(const Contestant& fit, const Dataset& dataset, const std::vector<uint32_t>& training,
                        const Atlas& atlas, float& most) {
    const std::vector<RasterPixel> texels = texel_pixels(atlas);
    std::vector<float> squares(texels.size()), count(texels.size());
    for (const uint32_t v : uncertainty_views(training)) {
        const View& view = dataset.views[v];
        std::vector<RasterPixel> pixels = texels;
        leave_out_hidden(view, atlas, pixels);
        std::vector<ErrorBar> bars;
        fit.error_bars(view, pixels, bars);
        for (size_t t = 0; t < pixels.size(); ++t) {
            if (pixels[t].triangle == no_triangle) continue;
            squares[t] += bars[t].fit.squaredNorm() / 3;  // infinite where it is not known
            ++count[t];
        }
    }
    for (size_t t = 0; t < squares.size(); ++t) squares[t] = count[t] > 0 ? std::sqrt(squares[t] / count[t]) : 0;
    most = float(end_of_scale(squares));
    for (float& value : squares) value = std::isfinite(value) ? std::min(value, most) : most;
    PageMap map = parameter_maps(std::vector<TexelMap>{{"uncertainty", {"uncertainty"}, 0}}, squares, atlas)[0];
    map.fixed_step = {most / steps_of_scale, 0, 0};
    return map;
}

}  // namespace radiafit::tools

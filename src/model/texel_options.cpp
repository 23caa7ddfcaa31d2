#include "model/texel_options.h"

#include "model/limits.h"
#include "model/texel_local.h"

namespace radiafit {

void check_options(const TexelOptions& o) {
    require("surface-side", o.surface_side, limits::map_side);
    require("mu", double(o.mu), limits::weight);
    require("clip-above", double(o.clip_above), limits::share);
    require("shadow-below", double(o.shadow_below), limits::share);
}

double bounds_penalty(const TexelOptions& options, std::span<const float> p) {
    double sum = 0;
    for (size_t i = 0; i < p.size(); ++i) {
        const auto [lowest, highest] = options.model->bounds[i];
        const double x = double(p[i]);
        if (!are_meant(options.model->bounds[i]) || (x >= lowest && x <= highest)) continue;
        const double beyond = x < lowest ? x - lowest : x - highest;
        sum += options.mode == Mode::paper ? (x - lowest) * (x - highest) : beyond * beyond / 2;
    }
    return double(options.mu) * sum;
}

}  // namespace radiafit

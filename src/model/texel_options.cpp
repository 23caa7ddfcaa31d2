#include "model/texel_options.h"

#include <fmt/format.h>

#include <cmath>

#include "base/error.h"
#include "model/texel_local.h"

namespace radiafit {

void check_options(const TexelOptions& o) {
    if (o.surface_side < 2 || o.surface_side > 64)
        throw UserError(fmt::format("surface-side = {}: choose 2 to 64 texels", o.surface_side));
    if (!(std::isfinite(o.mu) && o.mu >= 0))
        throw UserError(fmt::format("mu = {}: weights are finite and not negative", o.mu));
    const auto share = [](float x, const char* name) {
        if (!(x >= 0 && x <= 1)) throw UserError(fmt::format("{} = {}: choose 0 (off) to 1", name, x));
    };
    share(o.clip_above, "clip-above");
    share(o.shadow_below, "shadow-below");
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

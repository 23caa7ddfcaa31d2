#include "model/texel_options.h"

#include <fmt/format.h>

#include <cmath>

#include "base/error.h"

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

}  // namespace radiafit

#include "model/texel_options.h"

#include "model/limits.h"
#include "model/penalty.h"
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
        if (are_meant(options.model->bounds[i]))
            sum += ObjectiveText<double>::bound_error(double(p[i]), lowest, highest, double(options.mu),
                                                      options.mode == Mode::paper);
    }
    return sum;
}

}  // namespace radiafit

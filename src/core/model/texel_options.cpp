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

Vec3f shown_value(const TexelOptions& options, std::span<const float> p, const Vec3f& u, const Vec3f& v) {
    const std::array<float, 3> value = options.model->value(p, u, v);
    return from_curve(options.curve, Vec3f(value[0], value[1], value[2]));
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

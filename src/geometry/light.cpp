#include "geometry/light.h"

#include <fmt/format.h>

#include <cmath>

#include "base/error.h"

namespace radiafit {

void check_light(const Light& light, const std::string& name) {
    if (!light.place.allFinite() || !light.intensity.allFinite())
        throw UserError(fmt::format("{}: the light holds a number that is not finite; calibrate it again", name));
    const double length = light.place.norm();
    if (light.kind == Light::Kind::distant && std::abs(length - 1) > 1e-4)
        throw UserError(
            fmt::format("{}: the direction to the light has length {:.6g}; give a unit vector", name, length));
    if (light.intensity.minCoeff() < 0 || light.intensity.maxCoeff() <= 0)
        throw UserError(fmt::format("{}: the light's intensity ({}, {}, {}) must not be below 0, nor all 0", name,
                                    light.intensity.x(), light.intensity.y(), light.intensity.z()));
}

}  // namespace radiafit

#include "geometry/light.h"

#include <fmt/format.h>

#include <cmath>

#include "base/error.h"
#include "geometry/light_rules.h"

namespace radiafit {
namespace {
constexpr double least = 1e-12, largest = 1e12;  // any unit's
}

void check_intensity(const Vec3d& intensity, const std::string& name) {
    bool lit = false;
    for (int c = 0; c < 3; ++c) {
        const double value = intensity[c];
        if (value != 0 && !(value >= least && value <= largest))
            throw UserError(fmt::format("{}: the light's intensity is {:g} in a channel; give 0, or {:g} to {:g}", name,
                                        value, least, largest));
        lit |= value > 0;
    }
    if (!lit)
        throw UserError(fmt::format("{}: the light's intensity is 0 in every channel; leave the image out", name));
}

void check_light_vector(const Vec3d& vector, const std::string& name) {
    if (const double length = vector.stableNorm(); !(length >= least && length <= largest))
        throw UserError(
            fmt::format("{}: the light's vector ({}, {}, {}) has length {:.6g}; calibrate it, or leave the image out",
                        name, vector.x(), vector.y(), vector.z(), length));
}

void check_light(const Light& light, const std::string& name) {
    if (light.kind == Light::Kind::near) {
        if (!light.place.isZero(0)) check_light_vector(light.place, name);
    } else if (const double length = light.place.norm(); !(std::abs(length - 1) <= 1e-4)) {  // not a number either
        throw UserError(
            fmt::format("{}: the direction to the light has length {:.6g}; give a unit vector", name, length));
    }
    check_intensity(light.intensity, name);
}

}  // namespace radiafit

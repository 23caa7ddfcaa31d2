#include "rti/hemisphere.h"

#include <cmath>
#include <numbers>

namespace radiafit::tools {

std::vector<Vec3d> over_hemisphere(size_t count) {
    constexpr double lowest = 0.0017;                             // sine of the elevation
    const double turn = std::numbers::pi * (3 - std::sqrt(5.0));  // the golden angle
    std::vector<Vec3d> out;
    for (size_t i = 0; i < count; ++i) {
        const double z = 1 - (1 - lowest) * double(i) / double(count - 1), r = std::sqrt(1 - z * z);
        out.emplace_back(r * std::cos(double(i) * turn), r * std::sin(double(i) * turn), z);
    }
    return out;
}

}  // namespace radiafit::tools

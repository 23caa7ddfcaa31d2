#include "capture/lamp_functions.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

namespace radiafit::tools {

std::array<double, 6> ptm_functions(const Vec3d& lamp) {
    const double x = lamp.x(), y = lamp.y();
    return {x * x, y * y, x * y, x, y, 1};
}

std::vector<double> hsh_functions(const Vec3d& lamp, size_t count) {
    const double azimuth = std::atan2(lamp.y(), lamp.x()), z = lamp.z();
    const double cos1 = std::cos(azimuth), cos2 = std::cos(2 * azimuth), cos3 = std::cos(3 * azimuth);
    const double sin1 = std::sin(azimuth), sin2 = std::sin(2 * azimuth), sin3 = std::sin(3 * azimuth);
    // On the whole sphere, with the same azimuth, the cosine is w and the sine 2 r.
    const double w = 2 * z - 1, q = std::max(0.0, z - z * z), r = std::sqrt(q);
    const auto root = [](double over, double under) { return std::sqrt(over / (under * std::numbers::pi)); };
    std::vector<double> all = {root(1, 2),
                               root(6, 1) * r * cos1,
                               root(3, 2) * w,
                               root(6, 1) * r * sin1,
                               -root(30, 1) * q * cos2,
                               root(30, 1) * w * r * cos1,
                               root(5, 2) * (1 - 6 * q),
                               root(30, 1) * w * r * sin1,
                               -root(30, 1) * q * sin2,
                               2 * root(35, 1) * r * q * cos3,
                               -root(210, 1) * w * q * cos2,
                               2 * root(21, 1) * r * (1 - 5 * q) * cos1,
                               root(7, 2) * w * (1 - 10 * q),
                               2 * root(21, 1) * r * (1 - 5 * q) * sin1,
                               -root(210, 1) * w * q * sin2,
                               2 * root(35, 1) * r * q * sin3};
    all.resize(count);
    return all;
}

const TexelModel* hsh_model(size_t count) {
    for (const size_t order : {2u, 3u, 4u})
        if (order * order == count) return find_texel_model(fmt::format("hsh{}", order));
    return nullptr;
}

LampMatrix in_each_channel(std::span<const double> functions) {
    LampMatrix out = LampMatrix::Zero(3, 1 + 3 * Eigen::Index(functions.size()));
    for (size_t k = 0; k < functions.size(); ++k)
        for (int c = 0; c < 3; ++c) out(c, 1 + 3 * Eigen::Index(k) + c) = functions[k];
    return out;
}

}  // namespace radiafit::tools

#pragma once
#include <algorithm>
#include <cmath>

#include "synthetic/shading/angles.h"

namespace radiafit {

/// The highlight of Blinn 1977, a power of the half vector's cosine, scaled so that a surface lit along its normal
/// reflects all light that comes in (for other directions less). Same light as in oren_nayar(); u_z > 0.
inline double blinn(double exponent, const Angles& a) {
    const double half_z = std::max(0.0, a.u_z + a.v_z) / std::sqrt(std::max(1e-12, 2 + 2 * a.u_v));
    const double scale = (exponent + 2) * (exponent + 4) / (8 * (std::exp2(-0.5 * exponent) + exponent));
    return scale * std::pow(std::min(half_z, 1.0), exponent) * a.u_z;
}

}  // namespace radiafit

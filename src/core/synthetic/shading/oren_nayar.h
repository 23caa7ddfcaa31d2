#pragma once
#include <algorithm>

#include "synthetic/shading/angles.h"

namespace radiafit {

/// Rough diffuse reflection for albedo 1 (Oren and Nayar 1994, qualitative model): facets whose slopes have standard
/// deviation sigma, in radians. Under a light that gives a white diffuse surface facing it radiance 1; u_z > 0.
/// With s = u_x v_x + u_y v_y, their cos(phi_r - phi_i) sin(alpha) tan(beta) is s / max(u_z, v_z).
inline double oren_nayar(double sigma, const Angles& a) {
    const double variance = sigma * sigma;
    const double flat = 1 - 0.5 * variance / (variance + 0.33), retro = 0.45 * variance / (variance + 0.09);
    return a.u_z * (flat + retro * std::max(0.0, a.across()) / std::max(a.u_z, a.v_z));
}

}  // namespace radiafit

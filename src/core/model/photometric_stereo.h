#pragma once
#include <cstddef>
#include <span>
#include <vector>

#include "base/linear.h"

/// Normals of a surface from images that show it pixel on pixel under distant lamps (Woodham 1980), by sums that
/// shadows, highlights and interreflections sway little.
namespace radiafit {

/// Whether such lamps determine normals: three at least, and not nearly in one plane. Directions are unit.
bool lamps_give_normals(std::span<const Vec3d> directions);

/// The unit normal of a diffuse surface that would look most like this, z above 0; 0 where too little is lit.
/// values: [lamps] linear light of one pixel over its lamp's intensity; not a number: left out (masked, clipped).
/// Of the values, those below a tenth of the upper decile are shadow, and of the others the uppermost tenth (from ten
/// on) may be highlight: neither is used. The rest are fitted by least absolute errors (reweighted least squares).
Vec3f photometric_normal(std::span<const Vec3d> directions, std::span<const float> values);

}  // namespace radiafit

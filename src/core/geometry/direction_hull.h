#pragma once
#include <span>
#include <vector>

#include "base/linear.h"

/// Sets of directions: which of them are at the rim, which amid the others.
namespace radiafit {

/// The angle (radians) from `direction` to the cone that `others` span, all their sums with weights of 0 or more; 0
/// inside it. All of unit length; `others` may not be empty.
double angle_outside(std::span<const Vec3d> others, const Vec3d& direction);

/// The direction of that cone nearest to `direction`, of unit length: itself inside it.
Vec3d nearest_inside(std::span<const Vec3d> others, const Vec3d& direction);

/// `count` of the directions (unit length), spread over all of them: they are grouped into so many clusters, and of
/// each the one nearest to its middle is taken, so that the others surround it where they can. Ascending; the same for
/// the same input. count: 1 to their number.
std::vector<size_t> spread_over(std::span<const Vec3d> directions, size_t count);

}  // namespace radiafit

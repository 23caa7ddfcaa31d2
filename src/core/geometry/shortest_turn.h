#pragma once
#include <Eigen/Geometry>

#include "base/linear.h"

namespace radiafit {

/// The least rotation that turns `from` to `to`, neither of which is 0; by any axis across them where they oppose each
/// other. Off by 1e-7 radians at most, and by 1e-12 where they are not nearly opposed. What Eigen has for this brings
/// in a singular value decomposition, which takes seconds to compile.
Eigen::Quaterniond shortest_turn(const Vec3d& from, const Vec3d& to);

}  // namespace radiafit

#pragma once
#include <vector>

#include "base/linear.h"

namespace radiafit::tools {

/// So many unit directions (two at least), evenly over the hemisphere z > 0, from its pole to 0.1 degrees above its
/// rim.
std::vector<Vec3d> over_hemisphere(size_t count);

}  // namespace radiafit::tools

#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "stereo/plane_map.h"

namespace radiafit::tools {

/// The planes of `map` on which at least `least` of the `others` agree: the point at the pixel's centre, seen by the
/// other one, lies at a depth that differs by at most 1 %, comes back to within 1.5 pixels along that one's plane,
/// and has a normal within 45 degrees. Zero elsewhere.
PlaneMap agreed_planes(const PlaneMap& map, std::span<const PlaneMap* const> others, int least);

}  // namespace radiafit::tools

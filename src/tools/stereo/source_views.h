#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "capture/colmap_points.h"
#include "geometry/camera.h"

namespace radiafit::tools {

/// For each camera the others that its depths are compared with, best first, `most` at most: by the sum over the points
/// that both see of a weight of the angle between their rays, largest at 8 degrees, small where depths are badly known
/// or the surface looks different (as in Yao et al. 2018, "MVSNet", Section 4.1, whose peak is at 5). Pairs that share
/// fewer than 10 points are left out.
std::vector<std::vector<uint32_t>> choose_sources(std::span<const Camera> cameras, std::span<const SparsePoint> points,
                                                  size_t most);

}  // namespace radiafit::tools

#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "geometry/atlas.h"

namespace radiafit {

/// [triangles][3]: across the edge that is opposite to a corner; no_triangle: none, or several. Degenerate triangles
/// are across no edge.
std::vector<std::array<uint32_t, 3>> triangles_across(const TriangleAtlas& atlas);

}  // namespace radiafit

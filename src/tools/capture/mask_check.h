#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "capture/small_view.h"

namespace radiafit::tools {

/// What is wrong with the masks of some photographs, though not of all: those that are black where the mesh shows, and
/// lists of masks that go one photograph astray. A line for each. shown[view]: [height][width] of the view, not 0 =
/// the pixel sees the mesh.
std::vector<std::string> check_single_masks(std::span<const SmallView> views,
                                            std::span<const std::vector<uint8_t>> shown);

}  // namespace radiafit::tools

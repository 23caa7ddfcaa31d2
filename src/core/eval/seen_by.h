#pragma once
#include <cstdint>
#include <vector>

#include "dataset/image_stream.h"

namespace radiafit {

/// [triangles, or a grid's texels] Which of these views show each: one of their pixels has it at its centre, inside the
/// mask. Ascending. Draws every view once, and reads masks from `stream`, which is the dataset's.
std::vector<std::vector<uint32_t>> views_that_see(const Dataset& dataset, const ImageStream& stream,
                                                  const std::vector<uint32_t>& views);

/// [vertices] Likewise of a mesh: one of the vertex's triangles is shown so, or the vertex itself is, inside the mask
/// and no farther than what a pixel around it shows, by half a percent. (Triangles smaller than a pixel have no centre
/// in them.)
std::vector<std::vector<uint32_t>> views_that_see_vertices(const Dataset& dataset, const ImageStream& stream,
                                                           const std::vector<uint32_t>& views);

}  // namespace radiafit

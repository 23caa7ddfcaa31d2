#pragma once
#include <vector>

#include "geometry/atlas.h"
#include "geometry/raster.h"

namespace radiafit {

/// Pixels that see the centre of each texel, in the atlas's order; none where a texel isn't usable.
std::vector<RasterPixel> texel_pixels(const Atlas& atlas);

}  // namespace radiafit

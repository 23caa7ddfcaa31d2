#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "stereo/grey_image.h"
#include "stereo/plane_map.h"
#include "stereo/region.h"

namespace radiafit::tools {

/// A photograph and halves of it, until the longest side has no more than 200 pixels; full size first.
using Pyramid = std::vector<GreyImage>;
Pyramid pyramid_of(GreyImage image);

/// The plane of every pixel of `reference` whose ray meets the region, by comparison with `sources`. At the coarsest
/// size a plane sweep (Collins 1996): planes parallel to the image, 64 of them, evenly in 1/z within the region. From
/// there to full size PatchMatch stereo (Bleyer et al. 2011) in the order of a checkerboard (Galliani et al. 2015): a
/// pixel takes over a plane of eight others, or a random change of its present one, where its patch then agrees better,
/// in the mean over the better half of the sources. Zero where that cost stays above `most_cost`. Depends on nothing
/// but the arguments. Runs on one thread.
PlaneMap match_patches(const Pyramid& reference, std::span<const Pyramid* const> sources, const SearchBall& region,
                       float most_cost, uint64_t seed);

}  // namespace radiafit::tools

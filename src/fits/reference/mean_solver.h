#pragma once
#include <vector>

#include "base/rings.h"
#include "geometry/atlas.h"
#include "model/lfm.h"
#include "samples/sample_list.h"

namespace radiafit::fits {

/// The trivial baseline: one mean colour per texel, no view dependence, as a light field map with h = 1 and
/// g = L * mean. Texels without a sample take their tile's mean, tiles without one the mean of the tiles around their
/// vertices, else zero. layout: one term. Result in its order.
std::vector<float> mean_solver(const TriangleAtlas& atlas, const LfmLayout& layout, const SampleList& samples);

}  // namespace radiafit::fits

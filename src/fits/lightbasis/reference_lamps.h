#pragma once
#include "dataset/dataset.h"
#include "lightbasis/choose_kernel.h"

namespace radiafit::fits {

/// Lamps, with their half vectors if the basis goes by these, that values are to be known under: those of the training
/// views from the surface's middle; where each texel has a frame of its own, those of some texels. At most
/// most_reference_lamps, spread over all that there are; one at least.
std::vector<LampAndHalf> reference_lamps(const Dataset& dataset, const std::vector<uint32_t>& views,
                                         const LightBasis& basis, const ChosenKernel& kernel,
                                         const std::vector<LampValues>& texels);

}  // namespace radiafit::fits

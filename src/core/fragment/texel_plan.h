#pragma once
#include <span>

#include "fragment/fragment_plan.h"
#include "model/texel_options.h"

namespace radiafit {

/// What TexelFragmentEngine would allocate, without a context: the sum is what its bytes() would say. start() takes up
/// to eight layers of 32-bit RGBA more for its time.
std::vector<PlannedArray> plan_texel_engine(const Dataset& dataset, const Atlas& atlas, std::span<const uint32_t> views,
                                            const TexelOptions& options, const FragmentOptions& fragment_options,
                                            const Room& room = {});

}  // namespace radiafit

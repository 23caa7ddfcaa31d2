#pragma once
#include <vector>

#include "publish/publish.h"

namespace radiafit::tools {

/// Training views for which a fit's error bars are asked: a few, evenly spread.
std::vector<uint32_t> uncertainty_views(const std::vector<uint32_t>& training);

/// Of a fit that has error bars: how far noise moves the colour of each texel, the root mean square over channels and
/// those of uncertainty_views() that it faces. Where one of these does not follow from what was photographed, as large
/// as the scale is long. `most`, out: where the scale ends, in units of the fit's space; 0: of no texel is it known.
PageMap uncertainty_map(const Contestant& fit, const Dataset& dataset, const std::vector<uint32_t>& training,
                        const Atlas& atlas, float& most);

}  // namespace radiafit::tools

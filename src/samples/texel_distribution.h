#pragma once
#include <functional>

#include "samples/texel_source.h"

namespace radiafit {

/// What one image leaves: the texels that take a pixel, ascending, and the pixels' values.
struct TakenTexels {
    uint32_t image = 0;                    ///< position in the views
    std::vector<uint32_t> first;           ///< [TexelSource's blocks + 1] into those below; the last is their number
    std::vector<uint32_t> texels, pixels;  ///< room for all of the atlas
    std::vector<float> values;             ///< [taken][3] linear RGB

    uint32_t count() const { return first.back(); }
};

/// Streams `views` in linear light, one image per thread at a time, each through a distributor; `workers` as for
/// SampleCollector. take(images) gets them in order, a few at a time.
void distribute_views(const Dataset& dataset, const std::vector<uint32_t>& views,
                      const std::vector<Distributor*>& workers,
                      const std::function<void(std::span<const TakenTexels> images)>& take);

}  // namespace radiafit

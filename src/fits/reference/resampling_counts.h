#pragma once
#include <cstdint>

namespace radiafit::fits {

/// How much of the resampled light fields was made up. One entry is three values: a surface texel through a view texel.
struct ResamplingCounts {
    uint64_t entries = 0;
    uint64_t outside_hull = 0;   ///< of these, view texels outside the hull of the directions a texel is seen from
    uint64_t unseen_texels = 0;  ///< of these, of surface texels that no image sees
    double invented_share() const { return entries ? double(outside_hull + unseen_texels) / double(entries) : 0; }
    ResamplingCounts& operator+=(const ResamplingCounts& other);
};

}  // namespace radiafit::fits

#pragma once
#include <cstdint>
#include <span>
#include <vector>

namespace radiafit {

/// One radiance sample: one pixel in one texel, three residuals. 8 bytes, so that a list streams.
struct Sample {
    uint16_t rgb[3];  ///< target = rgb * SampleList::scale
    uint16_t local;   ///< tile-local texel
};

/// The samples that one tile takes from one image, in ascending texel order.
struct SampleGroup {
    uint32_t image;  ///< position in SampleList::views
    uint64_t first;  ///< into samples; ends where the next group begins
};

/// Every radiance sample of a set of views, grouped by tile, then image, then texel: the order problems read them in.
struct SampleList {
    std::vector<uint32_t> views;        ///< dataset view index of each image [L]
    std::vector<uint32_t> tile_groups;  ///< [tiles + 1] into groups
    std::vector<SampleGroup> groups;    ///< one more than there are groups: the last is a sentinel
    std::vector<Sample> samples;        ///< [S]
    float scale = 1.0f / 65535.0f;      ///< target per unit of Sample::rgb

    size_t image_count() const { return views.size(); }
    size_t tile_count() const { return tile_groups.empty() ? 0 : tile_groups.size() - 1; }
    std::span<const Sample> of_group(size_t group) const {
        return {samples.data() + groups[group].first, samples.data() + groups[group + 1].first};
    }
};

}  // namespace radiafit

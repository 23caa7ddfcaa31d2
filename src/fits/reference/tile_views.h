#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/rings.h"
#include "dataset/dataset.h"
#include "dataset/image_stream.h"
#include "geometry/atlas.h"

namespace radiafit::fits {

/// Every triangle as every image sees it, resampled to its tile: what factorization starts from (Chen et al. 2002).
struct TileViews {
    /// r, g, b; value = channel * scale. seen: the triangle shows at the texel's centre.
    struct Texel {
        uint16_t rgb[3];
        uint16_t seen;
    };
    std::vector<uint32_t> views;       ///< dataset view index of each image [L]
    std::vector<uint32_t> tile_first;  ///< [tiles + 1] into images
    std::vector<uint32_t> images;      ///< position in views, ascending within a tile: those that see any of its texels
    std::vector<size_t> texel_first;   ///< [tiles + 1] into texels
    std::vector<Texel> texels;         ///< of each tile [its images][its texels]
    float scale = 1.0f / 65535.0f;

    std::span<const uint32_t> images_of(uint32_t tile) const {
        return {images.data() + tile_first[tile], images.data() + tile_first[tile + 1]};
    }
    /// Texels of the i-th image of a tile.
    std::span<const Texel> of(uint32_t tile, size_t i) const {
        const size_t each = (texel_first[tile + 1] - texel_first[tile]) / images_of(tile).size();
        return {texels.data() + texel_first[tile] + i * each, each};
    }
};

/// Bilinear look-ups at the texels' projected centres, among the four pixels around that show the triangle or one that
/// shares a vertex with it, inside the mask. A texel is seen where the pixel that holds its centre is such a pixel.
/// 8 bytes per tile, image that sees it and texel.
TileViews resample_tiles(const Dataset& dataset, const TriangleAtlas& atlas, const std::vector<uint32_t>& views,
                         TargetSpace space);

}  // namespace radiafit::fits

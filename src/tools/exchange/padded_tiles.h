#pragma once
#include <array>
#include <span>
#include <vector>

#include "geometry/atlas.h"
#include "geometry/surface_lookup.h"

namespace radiafit::tools {

/// An image of numbers, row 0 on top.
struct TextureImage {
    int width = 0, height = 0, channels = 0;
    std::vector<float> values;  ///< [height][width][channels]
};

/// Where triangles are in a texture that others look up linearly: as in the atlas, two share a rectangle, but each
/// has a texel around it that continues it, so that no colour of a triangle that isn't its neighbour comes in. A
/// triangle of side n has its corners at (1, 1), (n + 1, 1), (1, n + 1) in a rectangle of (n + 3) x (n + 4) texels, the
/// odd one turned by half a circle. All sides are the atlas's largest.
class PaddedTiles {
public:
    /// The atlas must outlive it. Throws UserError for a texture wider than 16384.
    explicit PaddedTiles(const TriangleAtlas& atlas);

    int width() const { return width_; }
    int height() const { return height_; }
    /// The triangle's three corners, in texels from the top left corner of the texture.
    std::array<std::array<float, 2>, 3> corners(uint32_t triangle) const;
    /// Values [texels][channels] of the atlas in this layout; 0 where no triangle is.
    TextureImage bake(std::span<const float> values, int channels, SurfaceLookup lookup) const;

private:
    std::array<int, 2> rectangle(uint32_t triangle) const;

    const TriangleAtlas* atlas_;
    int side_, per_row_, width_, height_;
};

/// A triangle's corners in the atlas's layout, in texels from the top left corner.
std::array<std::array<float, 2>, 3> atlas_corners(const TriangleAtlas& atlas, uint32_t triangle);
/// Values [texels][channels] in the atlas's layout: a grid's.
TextureImage in_layout(const Atlas& atlas, std::span<const float> values, int channels);

}  // namespace radiafit::tools

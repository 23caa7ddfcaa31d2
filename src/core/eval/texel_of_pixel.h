#pragma once
#include "geometry/atlas.h"
#include "geometry/raster.h"

namespace radiafit {

/// The texel that a pixel shows: over a grid its own, of a mesh the one that it falls in.
class TexelOfPixel {
public:
    /// The atlas must outlive it.
    explicit TexelOfPixel(const Atlas& atlas)
        : atlas_(&atlas), triangles_(dynamic_cast<const TriangleAtlas*>(&atlas)) {}
    /// Of a pixel that sees the surface.
    uint32_t operator()(const RasterPixel& pixel) const {
        if (!triangles_) return pixel.triangle;
        return pixel.triangle * atlas_->texels_per_tile() + triangles_->local_at(pixel.triangle, pixel.b1, pixel.b2);
    }

private:
    const Atlas* atlas_;
    const TriangleAtlas* triangles_;  ///< null over a grid
};

}  // namespace radiafit

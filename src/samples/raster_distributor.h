#pragma once
#include "geometry/raster.h"
#include "samples/distributor.h"

namespace radiafit {

/// Distribution by the CPU rasterizer, for triangle atlases.
class RasterDistributor final : public Distributor {
public:
    /// Both must outlive the distributor.
    explicit RasterDistributor(const TriangleAtlas& atlas) : atlas_(&atlas) {}
    void distribute(const Camera& camera, const TargetImage& image, Distribution& out) override;

private:
    const TriangleAtlas* atlas_;
    Rasterizer rasterizer_;
    std::vector<uint32_t> items_;        ///< [height * width] texel or no_texel
    std::vector<uint8_t> tile_visible_;  ///< [tiles]
};

}  // namespace radiafit

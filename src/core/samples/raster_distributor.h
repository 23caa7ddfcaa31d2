#pragma once
#include <memory>

#include "base/parallel.h"
#include "geometry/raster.h"
#include "samples/distributor.h"

namespace radiafit {

/// Distribution by the CPU rasterizer, for triangle atlases.
class RasterDistributor final : public Distributor {
public:
    /// Both must outlive the distributor.
    explicit RasterDistributor(const TriangleAtlas& atlas);
    void distribute(const Camera& camera, const TargetImage& image, Distribution& out) override;

private:
    void fill_items(const TargetImage& image, Distribution& out);

    const TriangleAtlas* atlas_;
    Rasterizer rasterizer_;
    std::vector<uint32_t> items_;        ///< [height * width] texel or no_texel, and one more that is no_texel
    std::vector<uint8_t> tile_visible_;  ///< [tiles]
    /// [side] barycentric weights of a tile's texels, padded to whole vectors; empty for sides that no tile has.
    std::vector<std::array<std::vector<float>, 3>> weights_;
    std::vector<uint32_t> tile_pixels_;  ///< where a tile's texels project to, padded to whole vectors
};

/// Workers for build_sample_list() and write_records(), one for each thread; see worker_pointers().
std::vector<std::unique_ptr<Distributor>> raster_distributors(const TriangleAtlas& atlas, int count = thread_count());
std::vector<Distributor*> worker_pointers(const std::vector<std::unique_ptr<Distributor>>& distributors);

}  // namespace radiafit

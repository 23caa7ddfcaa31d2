#pragma once
#include <cstdint>
#include <vector>

#include "dataset/dataset.h"
#include "dataset/image_stream.h"
#include "geometry/atlas.h"
#include "samples/sample_list.h"

namespace radiafit {

inline constexpr uint32_t no_pixel = 0xffffffffu;

/// Which texel takes which pixel of one image, by the rule of Section 5.1: the item buffer holds the texel that each
/// pixel centre sees; a texel takes the pixel its own centre projects to (floor of the pixel coordinates) if that
/// pixel's item is this texel and the mask holds it. So a pixel feeds at most one texel, a texel takes at most one
/// pixel.
struct Distribution {
    std::vector<uint32_t> texel_pixel;  ///< [texels] pixel index (row * width + column) or no_pixel
    uint32_t covered_pixels = 0;        ///< pixels with an item, inside the mask
    uint32_t kept_pixels = 0;           ///< of these, taken by a texel
};

/// Distributes images: by the CPU rasterizer here, by OpenGL in gl/.
class Distributor {
public:
    virtual ~Distributor() = default;
    /// The mask is read from image.alpha. Reuses out's storage.
    virtual void distribute(const Camera& camera, const TargetImage& image, Distribution& out) = 0;
};

/// Statistics behind claim C17.
struct DistributionStatistics {
    uint64_t covered_pixels = 0, kept_pixels = 0, samples = 0;
    uint64_t texels = 0;                  ///< usable texels
    std::vector<uint64_t> texels_taking;  ///< [samples] how many usable texels take so many; up to the most
    double kept_share() const { return covered_pixels ? double(kept_pixels) / double(covered_pixels) : 0; }
    double median_samples_per_texel = 0;  ///< over usable texels
};

/// Distributes the given views and groups what they leave. `workers` holds one distributor per thread to use
/// (parallel_for's workers), or a single one that is then used from the calling thread only.
SampleList build_sample_list(const Dataset& dataset, const Atlas& atlas, const std::vector<uint32_t>& views,
                             std::vector<Distributor*> workers, TargetSpace space = TargetSpace::stored,
                             DistributionStatistics* statistics = nullptr);

}  // namespace radiafit

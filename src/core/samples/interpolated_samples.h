#pragma once
#include <memory>
#include <vector>

#include "dataset/dataset.h"
#include "dataset/image_stream.h"
#include "geometry/atlas.h"
#include "samples/image_samples.h"

namespace radiafit {

/// Takes every texel that an image shows, with the image's colour at the texel's centre: other than by Distributor's
/// rule, several texels may look at one pixel, so that fine texels get a sample of every image that shows them.
///
/// A texel is shown if its triangle faces the camera and the pixel that its centre projects to lies within the mask and
/// sees the triangle's plane, within half a percent of the depth or a pixel's width: the triangle itself, or a
/// neighbour that goes on from it. The colour is interpolated bilinearly between the centres of the four pixels around,
/// of those that lie within the mask and see the plane, too.
class InterpolatedSampler final : public TileSampler {
public:
    /// All must outlive it. texels: [texel_count()], those to be looked at; null: all.
    InterpolatedSampler(const Dataset& dataset, const TriangleAtlas& atlas, TargetSpace space,
                        const std::vector<bool>* texels = nullptr);
    ~InterpolatedSampler() override;
    int at_once() const override;
    int bits() const override { return 16; }
    float scale() const override { return scale_; }
    void collect(std::span<const uint32_t> views, size_t first, std::span<ImageSamples<Sample>> out) override;

private:
    class Worker;
    const Dataset* dataset_;
    const TriangleAtlas* atlas_;
    const std::vector<bool>* texels_;
    float scale_;
    std::vector<std::unique_ptr<Worker>> workers_;  ///< of each thread
};

/// All samples that InterpolatedSampler finds in these views.
SampleList interpolated_samples(const Dataset& dataset, const TriangleAtlas& atlas, const std::vector<uint32_t>& views,
                                TargetSpace space = TargetSpace::stored, const std::vector<bool>* texels = nullptr);

/// How many there are, without holding more than an image's for each thread. tiles, if given: [tile_count()], those of
/// each tile are added to it.
struct InterpolatedCounts {
    uint64_t samples = 0;
    uint64_t groups = 0;  ///< pairs of a tile and an image of which it takes samples
};
InterpolatedCounts count_interpolated(const Dataset& dataset, const TriangleAtlas& atlas,
                                      const std::vector<uint32_t>& views, std::vector<uint64_t>* tiles = nullptr);

}  // namespace radiafit

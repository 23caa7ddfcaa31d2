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
/// of those that do likewise.
class InterpolatedSampler final : public TileSampler {
public:
    /// Both must outlive it.
    InterpolatedSampler(const Dataset& dataset, const TriangleAtlas& atlas, TargetSpace space);
    ~InterpolatedSampler() override;
    int at_once() const override;
    int bits() const override { return 16; }
    float scale() const override { return scale_; }
    void collect(std::span<const uint32_t> views, size_t first, std::span<ImageSamples<Sample>> out) override;

private:
    class Worker;
    const Dataset* dataset_;
    const TriangleAtlas* atlas_;
    float scale_;
    std::vector<std::unique_ptr<Worker>> workers_;  ///< of each thread
};

/// All that it finds in these views.
SampleList interpolated_samples(const Dataset& dataset, const TriangleAtlas& atlas, const std::vector<uint32_t>& views,
                                TargetSpace space = TargetSpace::stored);

}  // namespace radiafit

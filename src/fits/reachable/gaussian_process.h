#pragma once
#include <vector>

#include "eval/contestant.h"
#include "geometry/atlas.h"
#include "reachable/direction_process.h"
#include "samples/sample_list.h"

namespace radiafit::fits {

struct GaussianProcessOptions {
    int surface_side = 12;  ///< of triangles' tiles
    int texels = 2000;      ///< that the process is learned from
};

/// A Gaussian process over view directions in every texel, all with the same parameters, which are those of most
/// evidence over texels drawn from the surface. It keeps every sample, at four numbers each.
class GaussianProcessTexels {
public:
    /// A texel with more samples is given every second, or third ... of them.
    static constexpr size_t most_samples = 128;

    /// Of samples as interpolated_samples() gives them. The dataset must outlive it.
    GaussianProcessTexels(const Dataset& dataset, const TriangleAtlas& atlas, const SampleList& samples,
                          const GaussianProcessOptions& options = {});
    /// As seen from `eye`, the posterior mean: the process's mean where nothing was seen.
    Vec3f colour(uint32_t texel, const Vec3f& eye) const;
    const DirectionProcess& process() const { return process_; }

private:
    struct Kept {
        float weight[3];
        uint32_t image;
    };

    const TriangleAtlas* atlas_;
    DirectionProcess process_;
    std::vector<Vec3f> eyes_;      ///< [images]
    std::vector<uint64_t> first_;  ///< [texels + 1] into kept_
    std::vector<Kept> kept_;
};

/// From these views. Throws UserError for a dataset that no light field map could be fitted to. The dataset must
/// outlive the contestant.
Contestant gaussian_process_of(const Dataset& dataset, const std::vector<uint32_t>& views, TargetSpace space,
                               const GaussianProcessOptions& options = {});

}  // namespace radiafit::fits

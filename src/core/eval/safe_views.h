#pragma once
#include <atomic>
#include <memory>
#include <mutex>
#include <vector>

#include "eval/contestant.h"
#include "geometry/surface_lookup.h"

namespace radiafit {

/// Shows a fit of colours by view direction over a mesh where its photographs determine it, and what can't go astray
/// elsewhere, as SafeRelighting does for fits under lamps:
///  - at a vertex the fit counts whole as long as the view is near the photographs that show the vertex's triangles: no
///    more than `trusted` beyond the cone of the directions to their cameras, and no more than `apart` from the
///    nearest; beyond, it fades within `fade` to a texel's mean colour over photographs;
///  - as it fades, it is no brighter, per channel, than `most` times the brightest that it is at these photographs.
/// Shares are linear between vertices. The mean and the brightest of a triangle's texels are what the fit itself shows
/// to `most_views` of its photographs; they are found when a view first needs them.
class SafeViews {
public:
    static constexpr double trusted = 0.17453292519943295, apart = 0.3490658503988659,
                            fade = 0.3490658503988659;  ///< radians: 10, 20 and 20 degrees
    static constexpr float most = 1.1f;
    static constexpr size_t most_views = 8;

    /// training: the views that were fitted. fit: of colours in this atlas, looked up so. The dataset must outlive it.
    SafeViews(const Dataset& dataset, const std::vector<uint32_t>& training, std::shared_ptr<const TriangleAtlas> atlas,
              SurfaceLookup lookup, Contestant fit);

    /// As Contestant's. Thread-safe.
    void shade(const View& view, const std::vector<RasterPixel>& pixels, std::vector<float>& rgb, int worker) const;
    /// How much of the fit a camera there sees of the surface that faces it: in the mean over area, as it is seen.
    double share_of_fit(const Vec3d& eye) const;
    /// Of a vertex; 1 where no photograph shows it, which makes no colour safer than another.
    float share_at(uint32_t vertex, const Vec3d& eye) const;
    TargetSpace space() const { return fit_.space; }

private:
    /// What the fit shows of a texel to photographs of its triangle.
    struct Bounds {
        Vec3f mean = Vec3f::Zero(), brightest = Vec3f::Zero();
    };
    struct Shares {  ///< of a thread
        Vec3d eye = Vec3d::Zero();
        std::vector<float> at;  ///< [vertices] negative: not known
    };
    void find_bounds(const std::vector<uint32_t>& triangles, int worker) const;

    const Dataset* dataset_;
    std::shared_ptr<const TriangleAtlas> atlas_;
    TexelLookup lookup_;
    Contestant fit_;
    std::vector<std::vector<uint32_t>> of_triangle_, of_vertex_;  ///< training views that show each
    mutable std::vector<Shares> shares_;
    mutable std::mutex finding_;
    mutable std::vector<Bounds> bounds_;               ///< [texels] of triangles that are known
    mutable std::vector<std::atomic<uint8_t>> known_;  ///< [triangles]
};

/// `fit` as SafeViews shows it, with the same error bars.
Contestant safe_contestant_of(const Dataset& dataset, const std::vector<uint32_t>& training,
                              std::shared_ptr<const TriangleAtlas> atlas, SurfaceLookup lookup, Contestant fit);

}  // namespace radiafit

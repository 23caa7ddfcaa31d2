#pragma once
#include <atomic>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "eval/contestant.h"
#include "geometry/surface_lookup.h"

namespace radiafit {

/// Shows a fit of colours by view direction over a mesh where its photographs determine it, and what can't go astray
/// elsewhere, as SafeRelighting does for fits under lamps. What counts is the angle, at a point of the surface, between
/// the directions to the camera and to the nearest photograph that shows the point; where these photographs are on
/// average more than `dense` from their next one, in proportion less:
///  - beyond `apart` the fit fades, within `fade`, to a texel's mean colour over its photographs;
///  - beyond `bound_from`, wholly so `bound_within` farther, no channel differs from that mean by more than
///    `most` times as much as the fit does at one of these photographs.
/// Angles are linear between vertices. Mean and bounds of a triangle's texels are what the fit itself shows to
/// `most_views` of its photographs; they are found when a view first needs them.
///
/// The angles were chosen on the gold cape: on views that are 25 degrees from all that are fitted, a view basis gains
/// 0.8 dB by this, and its worst view is 0.1 dB below the mean colours, where it was 2.4 dB; in the usual split nothing
/// is lost. (Of a made scene without noise, which is right farther off, up to 0.5 dB are.) Whether a view lies inside
/// the cone of its photographs' directions made no difference beside that angle.
class SafeViews {
public:
    static constexpr double degree = 0.017453292519943295;
    static constexpr double apart = 15 * degree, fade = 40 * degree;
    static constexpr double dense = 11 * degree;
    static constexpr double bound_from = 8 * degree, bound_within = 10 * degree;
    static constexpr float most = 1;
    static constexpr size_t most_views = 8;

    /// training: the views that were fitted. fit: of colours in this atlas, looked up so. The dataset must outlive it.
    SafeViews(const Dataset& dataset, const std::vector<uint32_t>& training, std::shared_ptr<const TriangleAtlas> atlas,
              SurfaceLookup lookup, Contestant fit);

    /// What the fit shows of a texel to photographs of its triangle, zeros where there are none.
    struct Bounds {
        Vec3f mean = Vec3f::Zero();
        Vec3f reach = Vec3f::Zero();  ///< the largest difference from it
    };

    /// Changes colours of the fit, or nearly the fit's, that it shows to a view: rgb as Contestant's. Thread-safe.
    void bound(const View& view, const std::vector<RasterPixel>& pixels, std::vector<float>& rgb, int worker) const;
    /// How much of the fit a camera there sees of the surface that faces it: in the mean over area, as it is seen.
    double share_of_fit(const Vec3d& eye) const;
    /// That angle at a vertex, in radians; 0 where no photograph shows it, which makes no colour safer than another.
    float angle_at(uint32_t vertex, const Vec3d& eye) const;
    /// How much of the fit is shown so far from the nearest photograph (radians).
    static float share_at(float angle);
    TargetSpace space() const { return fit_.space; }
    const std::vector<Bounds>& all_bounds() const;  ///< [texels]
    /// [vertices] what angles are divided by, 1 at least: as many times `dense` are photographs apart there.
    const std::vector<float>& spacings() const { return spacings_; }
    /// [vertices] which views show each. Ascending.
    const std::vector<std::vector<uint32_t>>& views_of_vertices() const { return of_vertex_; }

private:
    struct Angles {  ///< of a thread
        Vec3d eye = Vec3d::Zero();
        std::vector<float> at;  ///< [vertices] negative: not known
    };
    std::vector<uint32_t> views_of(uint32_t triangle) const;
    bool is_seen(uint32_t triangle) const;
    void find_bounds(std::span<const uint32_t> triangles, int worker) const;

    const Dataset* dataset_;
    std::shared_ptr<const TriangleAtlas> atlas_;
    TexelLookup lookup_;
    Contestant fit_;
    std::vector<std::vector<uint32_t>> of_vertex_;  ///< training views that show each
    std::vector<float> spacings_;
    mutable std::vector<Angles> angles_;
    mutable std::mutex finding_;
    mutable std::vector<Bounds> bounds_;               ///< [texels] of triangles that are known
    mutable std::vector<std::atomic<uint8_t>> known_;  ///< [triangles]
};

/// `shown`, which is the fit or nearly so, within these bounds, with its own error bars.
Contestant safe_contestant_of(std::shared_ptr<const SafeViews> bounds, Contestant shown);

}  // namespace radiafit

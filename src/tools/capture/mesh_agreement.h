#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "capture/coverage.h"
#include "capture/small_view.h"
#include "capture/surface_points.h"
#include "geometry/mesh.h"
#include "geometry/raster.h"

/// Whether neighbouring photographs show the same colours at the same places of a mesh, as they do where cameras, mesh
/// and photographs belong together.
namespace radiafit::tools {

/// The colour of a point of the surface in one photograph.
struct ColourSample {
    uint32_t point;
    std::array<float, 3> rgb;  ///< sRGB-coded, 1 = white
};

/// The points that a view shows unoccluded, no more than 72 degrees from their normals, inside its mask; ascending.
/// raster has drawn the mesh with the view's camera; null: as if nothing hid anything.
std::vector<ColourSample> observe(std::span<const SurfacePoint> points, const SmallView& view,
                                  const Rasterizer* raster);

/// Sums over points that two views share; of several pairs they add up.
struct SharedColours {
    uint64_t points = 0, pairs = 0;
    double covariance = 0;  ///< of the two views' colours about their means, so that exposure does not count
    double variance = 0;    ///< geometric mean of both views', so that contrast does not count either
    double difference = 0;  ///< summed absolute difference, mean of the channels

    /// From -1 to 1: 1 where both show the same, 0 where what they show has nothing in common or nothing varies.
    double correlation() const;
    /// Whether there is more to see than noise.
    bool vary() const;
    double mean_difference() const { return points ? difference / double(points) : 0; }
    SharedColours& operator+=(const SharedColours& other);
};
/// None of fewer than 30 points.
SharedColours compare(std::span<const ColourSample> a, std::span<const ColourSample> b);

using Pairs = std::vector<std::pair<size_t, size_t>>;

/// Each view with those `neighbours` whose directions from the centre are nearest and within 60 degrees; each pair
/// once.
Pairs neighbour_pairs(std::span<const SmallView> views, const Vec3d& centre, size_t neighbours);

/// What a mesh is worth to some views.
struct MeshAgreement {
    Coverage coverage;
    double seeing = 0;  ///< share of the views of which the mesh fills 2 % or more
    SharedColours colours;

    /// From 0 to 2, 2 the best: how outlines agree (with masks what both have over what either has; else `seeing`,
    /// since a mesh that fills the images would seem best), and how colours do.
    double value(bool masked) const;
};
MeshAgreement measure_agreement(const Mesh& mesh, std::span<const SurfacePoint> points,
                                std::span<const SmallView> views, const Pairs& pairs);

/// The same guessed without drawing the mesh, to compare frames by: the share of the points facing a view that are
/// inside its mask, and how colours correlate, as if nothing hid anything.
double guess_agreement(std::span<const SurfacePoint> points, std::span<const SmallView> views, const Pairs& pairs);

bool has_masks(std::span<const SmallView> views);

}  // namespace radiafit::tools

#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "geometry/camera.h"
#include "geometry/raster.h"

/// How much of photographs a mesh covers.
namespace radiafit::tools {

/// Counts of pixels, of one photograph or of many.
struct Coverage {
    uint64_t object = 0;  ///< inside the masks; without masks all pixels
    uint64_t both = 0;    ///< those of them whose centre sees the mesh
    uint64_t mesh = 0;    ///< whose centre sees the mesh, inside the masks or not

    double share() const { return object ? double(both) / double(object) : 0; }
    /// What both have over what either has, 1 where mesh and masks agree.
    double overlap() const { return object + mesh > both ? double(both) / double(object + mesh - both) : 0; }
    /// Whether black rather than white is where the mesh shows, in masks of that many pixels.
    bool inverted(uint64_t pixels) const;
    Coverage& operator+=(const Coverage& other);
};

/// raster has drawn the mesh; mask: of its size, not 0 = object; empty: all.
Coverage count_pixels(const Rasterizer& raster, const std::vector<uint8_t>& mask);
/// shown: which pixels see the mesh, not 0 = they do.
Coverage count_pixels(const std::vector<uint8_t>& shown, const std::vector<uint8_t>& mask);

/// The point that cameras look at: of least summed squared distance to the rays through `aims`, in pixels of each, or
/// to the optical axes where there are none. None where they are parallel.
std::optional<Vec3d> meeting_point(std::span<const Camera> cameras, std::span<const Vec2d> aims = {});

}  // namespace radiafit::tools

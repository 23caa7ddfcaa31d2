#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/linear.h"

namespace radiafit::tools {

/// Cuts polygons into triangles in their own plane, seen along Newell's normal (Sutherland, Sproull and Schumacker, A
/// Characterization of Ten Hidden-Surface Algorithms, 1974): around the first corner where that fills the polygon, as
/// it does every convex one; else by clipping ears (Meisters, Polygons have ears, 1975). Repeated and collinear corners
/// are taken, and holes that an edge to and fro joins to the outline.
class PolygonCutter {
public:
    /// Three corners or more. False for a polygon that crosses itself, has no area, or has more corners than time is
    /// spent on: its triangles are those around the first corner.
    bool cut(std::span<const Vec3d> corners);
    /// Of the last polygon: indices of its corners; two fewer than corners.
    const std::vector<std::array<uint32_t, 3>>& triangles() const { return triangles_; }

private:
    bool clip_ears();
    bool is_ear(uint32_t corner);
    double twice_area(uint32_t a, uint32_t b, uint32_t c) const;

    std::vector<std::array<uint32_t, 3>> triangles_;
    std::vector<Vec2d> points_;            ///< in the plane, counter-clockwise
    std::vector<uint32_t> before_, next_;  ///< of the corners that are left
    double least_area_ = 0;                ///< twice; below it corners count as collinear
    uint64_t tests_left_ = 1000000000;     ///< of a corner against an ear, for all polygons of a file
};

}  // namespace radiafit::tools

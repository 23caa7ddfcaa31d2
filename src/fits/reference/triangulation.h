#pragma once
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/linear.h"
#include "base/rings.h"

namespace radiafit::fits {

/// Delaunay triangulation of scattered points in the plane, for piecewise linear interpolation of what is known at
/// them (by Qhull). Points in one cell of a grid of 1e-6 of the set's extent are one: the first represents all.
class Triangulation {
public:
    /// At least one point, all finite; std::invalid_argument otherwise. Points on one line have no triangles, so that
    /// no place is inside: all take the value at the nearest point between neighbours on the line.
    explicit Triangulation(std::span<const Vec2d> points);

    const std::vector<std::array<uint32_t, 3>>& triangles() const { return triangles_; }  ///< counter-clockwise
    /// Segments of the convex hull; of points on one line, the segments between neighbours; of one point, {i, i}.
    const std::vector<std::array<uint32_t, 2>>& border() const { return border_; }

    /// A value at a place is the weighted sum of the values at three points; weights are >= 0 and sum to 1.
    struct Weights {
        std::array<uint32_t, 3> point;
        std::array<double, 3> weight;
        bool inside;  ///< in a triangle; else outside the hull: the weights are those of the hull's nearest point
    };
    Weights at(const Vec2d& place) const;
    /// At the nearest point of some segments between points.
    static Weights nearest(std::span<const Vec2d> points, std::span<const std::array<uint32_t, 2>> segments,
                           const Vec2d& place);

private:
    static constexpr size_t strip_count = 32;
    struct Boxed {
        Eigen::AlignedBox2d box;
        uint32_t triangle;
    };

    size_t strip_of(double y) const;

    std::vector<Vec2d> points_;
    std::vector<std::array<uint32_t, 3>> triangles_;
    std::vector<std::vector<Boxed>> strips_;  ///< horizontal ones, with the triangles that reach into each, ascending
    double bottom_ = 0, strip_height_ = 0;    ///< of the strips
    std::vector<std::array<uint32_t, 2>> border_;
};

}  // namespace radiafit::fits

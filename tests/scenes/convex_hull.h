#pragma once
#include <algorithm>
#include <vector>

#include "base/linear.h"

namespace radiafit::testing {

/// Twice the area of a, b, c: positive if they turn counter-clockwise.
inline double cross(const Vec2d& a, const Vec2d& b, const Vec2d& c) {
    return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

/// Corners of the convex hull, counter-clockwise (Andrew's monotone chain).
inline std::vector<Vec2d> hull_of(std::vector<Vec2d> points) {
    std::sort(points.begin(), points.end(),
              [](const Vec2d& a, const Vec2d& b) { return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y(); });
    std::vector<Vec2d> hull;
    for (int side = 0; side < 2; ++side) {
        const size_t first = hull.size();
        for (const Vec2d& p : points) {
            while (hull.size() >= first + 2 && cross(hull[hull.size() - 2], hull.back(), p) <= 0) hull.pop_back();
            hull.push_back(p);
        }
        hull.pop_back();
        std::reverse(points.begin(), points.end());
    }
    return hull;
}

}  // namespace radiafit::testing

#include "capture/polygon.h"

#include <algorithm>
#include <cmath>

namespace radiafit::tools {
namespace {

/// Twice the polygon's area long.
Vec3d newell_normal(std::span<const Vec3d> corners) {
    Vec3d sum = Vec3d::Zero();
    for (size_t k = 2; k < corners.size(); ++k)
        sum += (corners[k - 1] - corners[0]).cross(Vec3d(corners[k] - corners[0]));
    return sum;
}

}  // namespace

bool PolygonCutter::cut(std::span<const Vec3d> corners) {
    const auto count = static_cast<uint32_t>(corners.size());
    triangles_.clear();
    for (uint32_t k = 2; k < count; ++k) triangles_.push_back({0, k - 1, k});
    const Vec3d normal = newell_normal(corners);
    const double length = normal.norm();
    if (!(length > 0 && std::isfinite(length))) return false;
    // In a file of six digits, collinear corners are off their line by this much. Of a polygon that isn't flat no cut
    // is the right one, and seen along its normal even a convex outline turns inward a little.
    constexpr double rounding = 1e-6;
    double off_plane = 0, across = 0;
    for (const Vec3d& corner : corners) {
        off_plane = std::max(off_plane, std::abs((corner - corners[0]).dot(normal)) / length);
        across = std::max(across, (corner - corners[0]).norm());
    }
    const double least = -rounding * length - (off_plane > rounding * across ? 0.5 * off_plane * across : 0);
    bool filled = true;
    for (uint32_t k = 2; filled && k < count; ++k)
        filled = (corners[k - 1] - corners[0]).cross(Vec3d(corners[k] - corners[0])).dot(normal) >= least * length;
    if (filled) return true;

    const Vec3d up = normal / length;
    const Vec3d right = (std::abs(up.z()) < 0.9 ? Vec3d::UnitZ() : Vec3d::UnitX()).cross(up).normalized();
    const Vec3d upward = up.cross(right);
    points_.clear();
    for (const Vec3d& corner : corners) {
        const Vec3d p = corner - corners[0];
        points_.emplace_back(right.dot(p), upward.dot(p));
    }
    least_area_ = 1e-12 * length;
    const std::vector<std::array<uint32_t, 3>> fan = triangles_;
    if (clip_ears()) return true;
    triangles_ = fan;
    return false;
}

double PolygonCutter::twice_area(uint32_t a, uint32_t b, uint32_t c) const {
    const Vec2d ab = points_[b] - points_[a], ac = points_[c] - points_[a];
    return ab.x() * ac.y() - ab.y() * ac.x();
}

bool PolygonCutter::is_ear(uint32_t corner) {
    const uint32_t a = before_[corner], c = next_[corner];
    if (twice_area(a, corner, c) <= least_area_) return false;
    for (uint32_t other = next_[c]; other != a; other = next_[other]) {
        if (tests_left_ > 0) --tests_left_;
        // Only where the outline turns inward can it reach into an ear.
        if (twice_area(before_[other], other, next_[other]) > least_area_) continue;
        const Vec2d& p = points_[other];
        if (p == points_[a] || p == points_[corner] || p == points_[c]) continue;
        if (twice_area(a, corner, other) >= -least_area_ && twice_area(corner, c, other) >= -least_area_ &&
            twice_area(c, a, other) >= -least_area_)
            return false;
    }
    return true;
}

bool PolygonCutter::clip_ears() {
    const auto count = static_cast<uint32_t>(points_.size());
    before_.resize(count);
    next_.resize(count);
    for (uint32_t k = 0; k < count; ++k) before_[k] = (k + count - 1) % count, next_[k] = (k + 1) % count;
    triangles_.clear();
    uint32_t corner = 0;
    for (uint32_t left = count; left > 2; --left) {
        bool found = false;
        // Proper ears first; then corners on a line, whose triangles are empty and are skipped everywhere.
        for (const bool flat : {false, true})
            for (uint32_t tried = 0; !found && tried < left && tests_left_ > 0; ++tried, --tests_left_) {
                found =
                    flat ? std::abs(twice_area(before_[corner], corner, next_[corner])) <= least_area_ : is_ear(corner);
                if (!found) corner = next_[corner];
            }
        if (!found) return false;
        triangles_.push_back({before_[corner], corner, next_[corner]});
        next_[before_[corner]] = next_[corner];
        before_[next_[corner]] = before_[corner];
        corner = next_[next_[corner]];
    }
    return true;
}

}  // namespace radiafit::tools

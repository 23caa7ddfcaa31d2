#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <unordered_set>

#include "base/rng.h"
#include "synthetic/closed_mesh.h"

namespace radiafit {
namespace {

using Triangle = std::array<uint32_t, 3>;

/// A hull that grows point by point; a handful of thousand points, so every face is tried for every point.
class Hull {
public:
    explicit Hull(const std::vector<Vec3d>& points) : points_(points) {}

    void start(const std::array<uint32_t, 4>& corners) {
        middle_ = Vec3d::Zero();
        for (const uint32_t c : corners) middle_ += 0.25 * points_[c];
        for (size_t skip = 0; skip < 4; ++skip) {
            Triangle t = {corners[(skip + 1) % 4], corners[(skip + 2) % 4], corners[(skip + 3) % 4]};
            if (volume(t, middle_) > 0) std::swap(t[1], t[2]);
            faces_.push_back(t);
        }
    }

    void add(uint32_t point) {
        std::unordered_set<uint64_t> edges;  // of the faces the point sees
        std::vector<Triangle> kept;
        kept.reserve(faces_.size() + 2);
        for (const Triangle& t : faces_) {
            if (volume(t, points_[point]) > 0) {
                for (size_t k = 0; k < 3; ++k) edges.insert(key(t[k], t[(k + 1) % 3]));
            } else {
                kept.push_back(t);
            }
        }
        for (const Triangle& t : faces_) {
            if (volume(t, points_[point]) <= 0) continue;
            for (size_t k = 0; k < 3; ++k) {
                const uint32_t a = t[k], b = t[(k + 1) % 3];
                if (!edges.contains(key(b, a))) kept.push_back({a, b, point});
            }
        }
        faces_ = std::move(kept);
    }

    const std::vector<Triangle>& faces() const { return faces_; }

private:
    static uint64_t key(uint32_t a, uint32_t b) { return uint64_t(a) << 32 | b; }
    /// Above 0 if x lies on the outer side.
    double volume(const Triangle& t, const Vec3d& x) const {
        const Vec3d& a = points_[t[0]];
        return (points_[t[1]] - a).cross(points_[t[2]] - a).dot(x - a);
    }

    const std::vector<Vec3d>& points_;
    Vec3d middle_;
    std::vector<Triangle> faces_;
};

}  // namespace

std::vector<Vec3d> sphere_directions(int count) {
    std::vector<Vec3d> directions;
    for (int i = 0; i < count; ++i) {
        const double z = 1 - (2.0 * i + 1) / count, radius = std::sqrt(1 - z * z);
        const double turn = std::numbers::pi * (3 - std::sqrt(5.0)) * i;
        const auto at = uint64_t(3 * i);
        const Vec3d sway(random_uniform(1, at), random_uniform(1, at + 1), random_uniform(1, at + 2));
        directions.push_back(
            (Vec3d(radius * std::cos(turn), radius * std::sin(turn), z) + 0.02 / std::sqrt(double(count)) * sway)
                .normalized());
    }
    return directions;
}

std::vector<Triangle> sphere_hull(const std::vector<Vec3d>& directions) {
    const auto count = uint32_t(directions.size());
    // The first corners span a solid of some volume: each the farthest from those before it.
    const auto farthest = [&](auto measure) {
        uint32_t best = 0;
        for (uint32_t i = 1; i < count; ++i)
            if (measure(directions[i]) > measure(directions[best])) best = i;
        return best;
    };
    std::array<uint32_t, 4> corners = {};
    const Vec3d& p = directions[0];
    corners[1] = farthest([&](const Vec3d& x) { return (x - p).norm(); });
    const Vec3d axis = directions[corners[1]] - p;
    corners[2] = farthest([&](const Vec3d& x) { return axis.cross(x - p).norm(); });
    const Vec3d normal = axis.cross(directions[corners[2]] - p);
    corners[3] = farthest([&](const Vec3d& x) { return std::abs(normal.dot(x - p)); });

    Hull hull(directions);
    hull.start(corners);
    for (uint32_t i = 0; i < count; ++i)
        if (std::find(corners.begin(), corners.end(), i) == corners.end()) hull.add(i);
    if (hull.faces().size() != 2 * size_t(count) - 4) throw std::logic_error("sphere_hull: a point lies inside");
    return hull.faces();
}

}  // namespace radiafit

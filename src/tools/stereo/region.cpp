#include "stereo/region.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/error.h"
#include "capture/coverage.h"

namespace radiafit::tools {

SearchBall region_of(std::span<const Camera> cameras, double scale) {
    const std::optional<Vec3d> centre = meeting_point(cameras);
    if (!centre)
        throw UserError("the cameras look in parallel, at no point in common: photograph the object from around it");
    std::vector<double> radii;
    double nearest = INFINITY;
    for (const Camera& c : cameras) {
        const double distance = (c.center() - *centre).norm();
        nearest = std::min(nearest, distance);
        radii.push_back(distance * std::sin(std::atan(std::min(c.width / c.fx, c.height / c.fy) / 2)));
    }
    const auto middle = radii.begin() + ptrdiff_t(radii.size() / 2);
    std::nth_element(radii.begin(), middle, radii.end());
    constexpr double most = 0.9;  // of the way to the nearest camera
    return {*centre, std::min(scale * *middle, most * nearest)};
}

std::optional<std::array<float, 2>> inverse_depths(const SearchBall& region, const Camera& camera, double x, double y) {
    // |z r - c|² = R² with r of depth 1.
    const Vec3d r((x - camera.cx) / camera.fx, (y - camera.cy) / camera.fy, 1);
    const Vec3d c = camera.to_camera(region.centre);
    const double a = r.squaredNorm(), b = r.dot(c),
                 discriminant = b * b - a * (c.squaredNorm() - region.radius * region.radius);
    if (discriminant <= 0) return {};
    const double root = std::sqrt(discriminant), nearest = (b - root) / a, farthest = (b + root) / a;
    if (nearest <= 0) return {};
    return {{float(1 / farthest), float(1 / nearest)}};
}

}  // namespace radiafit::tools

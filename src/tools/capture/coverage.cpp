#include "capture/coverage.h"

#include <Eigen/LU>
#include <cmath>

namespace radiafit::tools {
namespace {

Coverage count(size_t pixels, const std::vector<uint8_t>& mask, const auto& sees_mesh) {
    Coverage count;
    for (size_t i = 0; i < pixels; ++i) {
        const bool object = mask.empty() || mask[i], seen = sees_mesh(i);
        count.object += object;
        count.mesh += seen;
        count.both += object && seen;
    }
    return count;
}

}  // namespace

Coverage& Coverage::operator+=(const Coverage& other) {
    object += other.object;
    both += other.both;
    mesh += other.mesh;
    return *this;
}

bool Coverage::inverted(uint64_t pixels) const {
    const Coverage black{pixels - object, mesh - both, mesh};
    return black.overlap() > 0.5 && black.overlap() > 2 * overlap() && share() < 0.5;
}

Coverage count_pixels(const Rasterizer& raster, const std::vector<uint8_t>& mask) {
    return count(raster.pixels().size(), mask, [&](size_t i) { return raster.pixels()[i].triangle != no_triangle; });
}

Coverage count_pixels(const std::vector<uint8_t>& shown, const std::vector<uint8_t>& mask) {
    return count(shown.size(), mask, [&](size_t i) { return shown[i] != 0; });
}

std::optional<Vec3d> meeting_point(std::span<const Camera> cameras, std::span<const Vec2d> aims) {
    Mat3d sum = Mat3d::Zero();
    Vec3d right = Vec3d::Zero();
    for (size_t i = 0; i < cameras.size(); ++i) {
        const Camera& c = cameras[i];
        const Vec2d pixel = aims.empty() ? Vec2d(c.cx, c.cy) : aims[i];
        const Vec3d in_camera((pixel.x() - c.cx) / c.fx, (pixel.y() - c.cy) / c.fy, 1);
        const Vec3d ray = (c.cam_from_world_rotation.transpose() * in_camera).normalized();
        const Mat3d across = Mat3d::Identity() - ray * ray.transpose();
        sum += across;
        right += across * c.center();
    }
    if (sum.determinant() < 1e-9 * std::pow(double(cameras.size()), 3)) return {};
    return Vec3d(sum.inverse() * right);
}

}  // namespace radiafit::tools

#include "geometry/camera.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace radiafit {
namespace {

// Wider than any lens or map, and narrow enough that no sum or product of coordinates overflows.
constexpr double least_focal_length = 1e-3, largest_focal_length = 1e9;  // pixels
constexpr double farthest_principal_point = 1e9;                         // pixels from the image's corner
constexpr double farthest_translation = 1e12;                            // world units

}  // namespace

Camera Camera::cropped(int x0, int y0, int w, int h) const {
    Camera c = *this;
    c.width = w;
    c.height = h;
    c.cx -= x0;
    c.cy -= y0;
    return c;
}

Camera Camera::look_at(const Vec3d& eye, const Vec3d& target, const Vec3d& up, double fov_y, int width, int height) {
    const Vec3d forward = (target - eye).normalized();
    Vec3d right = forward.cross(up.normalized());
    if (right.norm() < 1e-9) right = forward.cross(std::abs(forward.x()) < 0.5 ? Vec3d::UnitX() : Vec3d::UnitY());
    right.normalize();

    Camera c;
    c.width = width;
    c.height = height;
    c.fx = c.fy = 0.5 * height / std::tan(0.5 * fov_y);
    c.cx = 0.5 * width;
    c.cy = 0.5 * height;
    c.cam_from_world_rotation.row(0) = right;
    c.cam_from_world_rotation.row(1) = forward.cross(right);  // down
    c.cam_from_world_rotation.row(2) = forward;
    c.cam_from_world_translation = -c.cam_from_world_rotation * eye;
    return c;
}

void check_camera(const Camera& camera, const std::string& name) {
    const Mat3d& r = camera.cam_from_world_rotation;
    const bool finite = std::isfinite(camera.fx) && std::isfinite(camera.fy) && std::isfinite(camera.cx) &&
                        std::isfinite(camera.cy) && r.allFinite() && camera.cam_from_world_translation.allFinite();
    if (!finite)
        throw UserError(fmt::format("{}: the camera holds a number that is not finite; calibrate it again", name));
    if (camera.width <= 0 || camera.height <= 0)
        throw UserError(fmt::format("{}: the image size {} x {} must be positive", name, camera.width, camera.height));
    if (std::min(camera.fx, camera.fy) < least_focal_length || std::max(camera.fx, camera.fy) > largest_focal_length)
        throw UserError(
            fmt::format("{}: the focal lengths {} and {} must be positive pixels, from {} to {}; calibrate "
                        "it again",
                        name, camera.fx, camera.fy, least_focal_length, largest_focal_length));
    if (std::max(std::abs(camera.cx), std::abs(camera.cy)) > farthest_principal_point)
        throw UserError(fmt::format("{}: the principal point {}, {} lies more than {} pixels away; calibrate it again",
                                    name, camera.cx, camera.cy, farthest_principal_point));
    if (camera.cam_from_world_translation.cwiseAbs().maxCoeff() > farthest_translation)
        throw UserError(fmt::format("{}: the translation goes beyond {} units; move the scene to the origin", name,
                                    farthest_translation));
    const double skew = (r * r.transpose() - Mat3d::Identity()).cwiseAbs().maxCoeff();
    if (skew > 1e-4 || r.row(0).cross(r.row(1)).dot(r.row(2)) <= 0)
        throw UserError(fmt::format(
            "{}: the rotation is not orthonormal and right-handed (deviation {:.2g}); normalize its quaternion", name,
            skew));
}

}  // namespace radiafit

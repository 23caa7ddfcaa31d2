#pragma once
#include <string>

#include "base/linear.h"

namespace radiafit {

/// A pinhole camera, COLMAP's conventions: +x right, +y down, +z forward; the centre of the top-left pixel is (0.5,
/// 0.5). width and height are those of the stored (cropped) image: cropping shifts cx and cy.
struct Camera {
    int width = 0, height = 0;              ///< pixels
    double fx = 0, fy = 0, cx = 0, cy = 0;  ///< pixels
    Mat3d cam_from_world_rotation = Mat3d::Identity();
    Vec3d cam_from_world_translation = Vec3d::Zero();

    /// Spelled out, so that loops over many points can repeat it bit by bit (samples/raster_distributor.cpp).
    Vec3d to_camera(const Vec3d& w) const {
        const Mat3d& r = cam_from_world_rotation;
        const Vec3d& t = cam_from_world_translation;
        return {r(0, 0) * w.x() + r(0, 1) * w.y() + r(0, 2) * w.z() + t.x(),
                r(1, 0) * w.x() + r(1, 1) * w.y() + r(1, 2) * w.z() + t.y(),
                r(2, 0) * w.x() + r(2, 1) * w.y() + r(2, 2) * w.z() + t.z()};
    }
    /// Pixel coordinates and depth; meaningful for depth > 0 only.
    Vec3d project(const Vec3d& world) const {
        const Vec3d c = to_camera(world);
        return {fx * c.x() / c.z() + cx, fy * c.y() / c.z() + cy, c.z()};
    }
    Vec3d center() const { return -cam_from_world_rotation.transpose() * cam_from_world_translation; }
    /// The sub-rectangle [x0, x0+w) x [y0, y0+h) of this camera's image.
    Camera cropped(int x0, int y0, int w, int h) const;

    /// A camera at `eye` that looks at `target`, image y pointing away from `up`; vertical field of view in radians.
    static Camera look_at(const Vec3d& eye, const Vec3d& target, const Vec3d& up, double fov_y, int width, int height);
};

/// Throws UserError, prefixed by `name`, for a number that is not finite or beyond what the rasterizer can draw with
/// (camera.cpp has the bounds), sizes that are not positive, and a rotation that is not orthonormal to 1e-4.
void check_camera(const Camera& camera, const std::string& name);

}  // namespace radiafit

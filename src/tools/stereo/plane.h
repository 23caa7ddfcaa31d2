#pragma once
#include <cmath>

#include "geometry/camera.h"

/// Planes in front of a camera, and what they make of its pixels in another one.
namespace radiafit::tools {

/// A plane in camera coordinates as w = n / d, of all X with n·X = d: w·X = 1. On the ray r = ((x - cx) / fx,
/// (y - cy) / fy, 1) of a pixel it lies at 1/z = w·r. |w| is the inverse distance from the camera; w points away from
/// it, the surface's normal, which faces the camera, is -w / |w|.
using InversePlane = Vec3f;

inline Vec3f ray_of(const Camera& camera, double x, double y) {
    return {float((x - camera.cx) / camera.fx), float((y - camera.cy) / camera.fy), 1};
}

/// The plane through the point at 1/z = `inverse_depth` on the ray `r` whose normal, facing the camera, is `normal`.
inline InversePlane make_plane(const Vec3f& r, float inverse_depth, const Vec3f& normal) {
    return normal * (inverse_depth / normal.dot(r));
}

inline Vec3f normal_of(const InversePlane& plane) { return -plane.normalized(); }

/// Cosine of the angle between the normal and the direction to the camera.
inline float facing(const InversePlane& plane, const Vec3f& r) { return plane.dot(r) / (plane.norm() * r.norm()); }

/// A pixel's neighbourhood in another camera: position and its derivatives. Not in front of it: none() holds.
struct AffineMap {
    float x, y;                    ///< pixels
    float x_dx, x_dy, y_dx, y_dy;  ///< by pixels of the first camera
    float depth;                   ///< z in the second camera over z in the first
    bool none() const { return !(depth > 1e-6f); }
};

/// From one camera to another: X' = R X + t.
class CameraPair {
public:
    CameraPair(const Camera& from, const Camera& to)
        : fx_(float(to.fx)), fy_(float(to.fy)), cx_(float(to.cx)), cy_(float(to.cy)) {
        const Mat3d r = to.cam_from_world_rotation * from.cam_from_world_rotation.transpose();
        rotation_ = r.cast<float>();
        translation_ = (to.cam_from_world_translation - r * from.cam_from_world_translation).cast<float>();
        right_ = rotation_.col(0) / float(from.fx);
        down_ = rotation_.col(1) / float(from.fy);
        over_fx_ = float(1 / from.fx);
        over_fy_ = float(1 / from.fy);
    }

    /// The homography R + t wᵀ of the plane (Hartley and Zisserman 2004, Section 13.1), linearized at the pixel of ray
    /// r.
    AffineMap map(const InversePlane& w, const Vec3f& r) const {
        const Vec3f y = rotation_ * r + translation_ * w.dot(r);
        const Vec3f dx = right_ + translation_ * (w.x() * over_fx_), dy = down_ + translation_ * (w.y() * over_fy_);
        const float inverse = 1 / y.z(), px = y.x() * inverse, py = y.y() * inverse;
        return {fx_ * px + cx_,
                fy_ * py + cy_,
                fx_ * (dx.x() - px * dx.z()) * inverse,
                fx_ * (dy.x() - px * dy.z()) * inverse,
                fy_ * (dx.y() - py * dx.z()) * inverse,
                fy_ * (dy.y() - py * dy.z()) * inverse,
                y.z()};
    }

private:
    Eigen::Matrix3f rotation_;
    Vec3f translation_, right_, down_;
    float over_fx_, over_fy_, fx_, fy_, cx_, cy_;
};

}  // namespace radiafit::tools

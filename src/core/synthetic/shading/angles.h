#pragma once
#include "base/linear.h"

namespace radiafit {

/// What isotropic reflectance depends on: unit directions u to the light and v to the camera, in the frame whose z is
/// the surface's normal.
struct Angles {
    double u_z, v_z;  ///< cosines with the normal
    double u_v;       ///< cosine between the two

    static Angles of(const Vec3d& normal, const Vec3d& to_light, const Vec3d& to_camera) {
        return {normal.dot(to_light), normal.dot(to_camera), to_light.dot(to_camera)};
    }
    double across() const { return u_v - u_z * v_z; }  ///< u_x v_x + u_y v_y
};

}  // namespace radiafit

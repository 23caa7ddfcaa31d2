#pragma once
#include <algorithm>
#include <cmath>

#include "base/linear.h"
#include "geometry/light.h"

namespace radiafit::tools {

/// Where a lamp is, in the numbers that it is estimated by: the direction to it from the world's origin, and one over
/// its distance, in which far lamps are nearly linear.
struct LampPlace {
    Vec3d direction = Vec3d::UnitZ();
    double closeness = 0;  ///< 0: far away

    static LampPlace of(const Light& light) {
        if (light.kind == Light::Kind::distant) return {light.place, 0};
        return {light.place.normalized(), 1 / light.place.norm()};
    }
    /// Of intensity 1.
    Light light() const {
        if (closeness <= 0) return {Light::Kind::distant, direction, Vec3d::Ones()};
        return {Light::Kind::near, direction / closeness, Vec3d::Ones()};
    }
    /// Two unit directions at right angles to it.
    Eigen::Matrix<double, 3, 2> across() const {
        const Vec3d other = std::abs(direction.z()) < 0.9 ? Vec3d::UnitZ() : Vec3d::UnitX();
        Eigen::Matrix<double, 3, 2> out;
        out.col(0) = direction.cross(other).normalized();
        out.col(1) = direction.cross(out.col(0));
        return out;
    }
    /// By so much across, and closer by so much.
    LampPlace moved(const Vec3d& step) const {
        return {(direction + across() * step.head<2>()).normalized(), std::max(closeness + step.z(), 0.0)};
    }
    /// How light().place moves with moved()'s step: [x, y, z][2 across, closeness].
    Mat3d place_by_step() const {
        Mat3d out = Mat3d::Zero();
        const double length = closeness > 0 ? 1 / closeness : 1;
        out.leftCols(2) = length * across();
        if (closeness > 0) out.col(2) = -length * length * direction;
        return out;
    }
};

}  // namespace radiafit::tools

#pragma once
#include <Eigen/Core>

/// Short names for the few fixed-size types that geometry is written in.
namespace radiafit {
using Vec3f = Eigen::Vector3f;
using Vec2d = Eigen::Vector2d;
using Vec3d = Eigen::Vector3d;
using Mat3d = Eigen::Matrix3d;
}  // namespace radiafit

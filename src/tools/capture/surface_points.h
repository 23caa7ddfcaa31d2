#pragma once
#include <cstddef>
#include <optional>
#include <vector>

#include "base/linear.h"
#include "geometry/camera.h"
#include "geometry/mesh.h"

namespace radiafit::tools {

/// A point on a mesh, with its triangle's unit normal.
struct SurfacePoint {
    Vec3d position, normal;
};

/// Whether a camera at `eye` is within 72 degrees of the point's normal; beyond, a pixel spans too much surface.
inline bool faces(const SurfacePoint& point, const Vec3d& eye) {
    constexpr double least_cosine = 0.3;
    return (eye - point.position).normalized().dot(point.normal) >= least_cosine;
}

/// Where a camera sees the point, in pixels and depth: none if it does not face it, lies behind it, or has it less than
/// a pixel from the picture's border. eye: the camera's centre.
inline std::optional<Vec3d> project_facing(const SurfacePoint& point, const Camera& camera, const Vec3d& eye) {
    if (!faces(point, eye)) return {};
    const Vec3d at = camera.project(point.position);
    if (!(at.z() > 0 && at.x() >= 1 && at.y() >= 1 && at.x() < camera.width - 1 && at.y() < camera.height - 1))
        return {};
    return at;
}

/// About `wanted` points at which photographs are compared: few large triangles are cut into equal ones, of very many
/// only every n-th is taken. None on degenerate triangles.
std::vector<SurfacePoint> surface_points(const Mesh& mesh, size_t wanted);

}  // namespace radiafit::tools

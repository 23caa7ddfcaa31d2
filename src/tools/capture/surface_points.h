#pragma once
#include <cstddef>
#include <vector>

#include "base/linear.h"
#include "geometry/mesh.h"

namespace radiafit::tools {

/// A point on a mesh, with its triangle's unit normal.
struct SurfacePoint {
    Vec3d position, normal;
};

/// About `wanted` points at which photographs are compared: few large triangles are cut into equal ones, of very many
/// only every n-th is taken. None on degenerate triangles.
std::vector<SurfacePoint> surface_points(const Mesh& mesh, size_t wanted);

}  // namespace radiafit::tools

#include "capture/surface_points.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace radiafit::tools {

std::vector<SurfacePoint> surface_points(const Mesh& mesh, size_t wanted) {
    const size_t triangles = mesh.triangle_count();
    const size_t stride = std::max<size_t>(1, triangles / wanted);
    const auto side = static_cast<int>(std::ceil(std::sqrt(double(wanted) / double(triangles) * double(stride))));
    std::vector<SurfacePoint> points;
    for (size_t t = 0; t < triangles; t += stride) {
        const Vec3d a = mesh.positions[mesh.triangles[t][0]].cast<double>();
        const Vec3d u = mesh.positions[mesh.triangles[t][1]].cast<double>() - a;
        const Vec3d v = mesh.positions[mesh.triangles[t][2]].cast<double>() - a;
        const Vec3d normal = u.cross(v).normalized();
        if (!(std::abs(normal.norm() - 1) < 1e-6)) continue;  // degenerate
        for (int j = 0; j < side; ++j)
            for (int i = 0; i + j < side; ++i) {
                points.push_back({a + u * ((i + 1 / 3.0) / side) + v * ((j + 1 / 3.0) / side), normal});
                if (i + j + 1 < side)  // the turned triangle of the cell
                    points.push_back({a + u * ((i + 2 / 3.0) / side) + v * ((j + 2 / 3.0) / side), normal});
            }
    }
    return points;
}

}  // namespace radiafit::tools

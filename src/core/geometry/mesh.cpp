#include "geometry/mesh.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>

#include "base/error.h"

namespace radiafit {

bool is_degenerate(const Mesh& mesh, size_t triangle) {
    const auto& [i0, i1, i2] = mesh.triangles[triangle];
    if (i0 == i1 || i1 == i2 || i2 == i0) return true;
    const Vec3d a = (mesh.positions[i1] - mesh.positions[i0]).cast<double>();
    const Vec3d b = (mesh.positions[i2] - mesh.positions[i0]).cast<double>();
    const double twice_area = a.cross(b).norm();
    const double longest2 = std::max({a.squaredNorm(), b.squaredNorm(), (b - a).squaredNorm()});
    return !(twice_area > 1e-12 * longest2);  // also true for NaN
}

MeshDefects find_defects(const Mesh& mesh) {
    MeshDefects defects;
    std::vector<uint8_t> referenced(mesh.vertex_count(), 0);
    for (uint32_t t = 0; t < mesh.triangle_count(); ++t) {
        if (is_degenerate(mesh, t)) {
            defects.degenerate_triangles.push_back(t);
        } else {
            for (const uint32_t v : mesh.triangles[t]) referenced[v] = 1;
        }
    }
    for (uint32_t v = 0; v < mesh.vertex_count(); ++v)
        if (!referenced[v]) defects.unreferenced_vertices.push_back(v);
    return defects;
}

void check_mesh(const Mesh& mesh, const std::string& name) {
    if (mesh.positions.empty() || mesh.triangles.empty())
        throw UserError(fmt::format("{}: the mesh is empty ({} vertices, {} triangles); give one with triangles", name,
                                    mesh.vertex_count(), mesh.triangle_count()));
    for (size_t v = 0; v < mesh.vertex_count(); ++v)
        if (!mesh.positions[v].allFinite())
            throw UserError(fmt::format("{}: the position of vertex {} is not finite; repair the mesh", name, v));
    for (size_t t = 0; t < mesh.triangle_count(); ++t)
        for (const uint32_t v : mesh.triangles[t])
            if (v >= mesh.vertex_count())
                throw UserError(
                    fmt::format("{}: triangle {} refers to vertex {}, but there are only {}; repair the mesh", name, t,
                                v, mesh.vertex_count()));
}

std::vector<Vec3f> vertex_normals(const Mesh& mesh) {
    std::vector<Vec3d> sums(mesh.vertex_count(), Vec3d::Zero());
    for (size_t t = 0; t < mesh.triangle_count(); ++t) {
        if (is_degenerate(mesh, t)) continue;
        const auto& [i0, i1, i2] = mesh.triangles[t];
        const Vec3d p0 = mesh.positions[i0].cast<double>();
        const Vec3d cross =
            (mesh.positions[i1].cast<double>() - p0).cross(mesh.positions[i2].cast<double>() - p0);  // 2 area * normal
        for (const uint32_t v : mesh.triangles[t]) sums[v] += cross;
    }
    std::vector<Vec3f> normals(mesh.vertex_count(), Vec3f::UnitZ());
    for (size_t v = 0; v < normals.size(); ++v) {
        const double length = sums[v].norm();
        if (length > 0) normals[v] = (sums[v] / length).cast<float>();
    }
    return normals;
}

Frame make_frame(const Vec3f& unit_normal) {
    const Vec3f axis = std::abs(unit_normal.z()) < 0.9f ? Vec3f::UnitZ() : Vec3f::UnitX();
    const Vec3f tangent = axis.cross(unit_normal).normalized();
    return {tangent, unit_normal.cross(tangent), unit_normal};
}

std::vector<Frame> vertex_frames(const Mesh& mesh) {
    const std::vector<Vec3f> normals = vertex_normals(mesh);
    std::vector<Frame> frames(normals.size());
    std::transform(normals.begin(), normals.end(), frames.begin(), make_frame);
    return frames;
}

}  // namespace radiafit

#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "base/linear.h"

namespace radiafit {

/// An indexed triangle mesh in world space; counter-clockwise triangles face outward.
struct Mesh {
    std::vector<Vec3f> positions;                    ///< [V]
    std::vector<std::array<uint32_t, 3>> triangles;  ///< [F] indices into positions

    size_t vertex_count() const { return positions.size(); }
    size_t triangle_count() const { return triangles.size(); }
};

/// What a mesh suffers from without being unusable. Named, never repaired silently.
struct MeshDefects {
    std::vector<uint32_t> degenerate_triangles;   ///< area zero (or not finite), or a vertex twice: skipped everywhere
    std::vector<uint32_t> unreferenced_vertices;  ///< no non-degenerate triangle uses them: problems without samples
};
MeshDefects find_defects(const Mesh& mesh);
/// The one test of degeneracy: a vertex twice, or twice the area not above 1e-12 of the longest edge squared.
bool is_degenerate(const Mesh& mesh, size_t triangle);

/// Throws UserError, prefixed by `name`, for an empty mesh, an index out of range or a position that is not finite.
void check_mesh(const Mesh& mesh, const std::string& name);

/// Area-weighted unit normals [V]; +z for an unreferenced vertex.
std::vector<Vec3f> vertex_normals(const Mesh& mesh);

/// The local frame of a vertex: rows tangent, bitangent, normal; maps a world direction to the frame.
/// tangent = normalize(cross(|n.z| < 0.9 ? z : x, n)).
struct Frame {
    Vec3f tangent, bitangent, normal;
    Vec3f to_local(const Vec3f& d) const { return {tangent.dot(d), bitangent.dot(d), normal.dot(d)}; }
};
Frame make_frame(const Vec3f& unit_normal);
std::vector<Frame> vertex_frames(const Mesh& mesh);  ///< [V]

}  // namespace radiafit

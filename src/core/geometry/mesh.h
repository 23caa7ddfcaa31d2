#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "base/linear.h"

namespace radiafit {

struct Surroundings;

/// An indexed triangle mesh in world space; counter-clockwise triangles face outward.
struct Mesh {
    std::vector<Vec3f> positions;                                ///< [V]
    std::vector<std::array<uint32_t, 3>> triangles;              ///< [F] indices into positions
    std::shared_ptr<const Surroundings> surroundings = nullptr;  ///< of a part that was cut from a larger mesh

    size_t vertex_count() const { return positions.size(); }
    size_t triangle_count() const { return triangles.size(); }
};

inline constexpr uint32_t no_triangle = 0xffffffffu;

/// What a part of a mesh knows of the whole that it was cut from (geometry/mesh_part.h).
struct Surroundings {
    std::shared_ptr<const Mesh> whole;    ///< hides the part in images, as it did before
    std::vector<uint32_t> vertices;       ///< [V] index of each of the part's vertices in the whole, ascending
    std::vector<uint32_t> triangles;      ///< [F] index of each of the part's triangles in the whole, ascending
    std::vector<uint32_t> part_triangle;  ///< [whole's F] index in the part, or no_triangle
    /// [V] not 0: a vertex at the part's rim, whose other triangles were left out. It has no problem here.
    std::vector<uint8_t> rim;
    /// [V] where the vertex's block begins in the whole's parameters (LfmLayout): random starts depend on it.
    std::vector<uint64_t> blocks;
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

#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "geometry/mesh.h"

namespace radiafit {

/// A mesh as a fit needs it, and what was met on the way.
struct MeshFile {
    Mesh mesh;
    std::vector<std::string> notes;  ///< defects, counted, one line each; empty for a clean file
};

/// Reads any format assimp knows. All meshes of the file are merged; polygons are triangulated; vertices are welded
/// where their positions are equal in every bit (so that texture seams don't cut the surface), in order of first
/// appearance. Points, lines, normals, texture coordinates and materials are left out.
/// Throws UserError for a missing or unreadable file, a mesh without triangles and positions that are not finite.
MeshFile read_mesh_file(const std::filesystem::path& file);

/// Merges vertices of bitwise equal position (-0 equals 0); exported for tests. Returns the number merged away.
size_t weld_positions(Mesh& mesh);

}  // namespace radiafit

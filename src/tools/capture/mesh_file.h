#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "geometry/mesh.h"

namespace radiafit::tools {

/// A mesh as a fit needs it, and what was met on the way.
struct MeshFile {
    Mesh mesh;
    std::vector<std::string> notes;  ///< defects, counted, one line each; empty for a clean file
};

/// Reads PLY (text, binary of either byte order) and OBJ. All objects of the file are merged; polygons become triangles
/// around their first corner; vertices are welded where their positions are equal in every bit (so that texture seams
/// don't cut the surface), in order of first appearance. Points, lines, normals, texture coordinates and materials are
/// left out.
/// Throws UserError that names file (text: line) and cure for anything missing, unreadable, of another format,
/// malformed, cut, out of range or not finite, and for a mesh without triangles.
MeshFile read_mesh_file(const std::filesystem::path& file);

/// Merges vertices of bitwise equal position (-0 equals 0); exported for tests. Returns the number merged away.
size_t weld_positions(Mesh& mesh);

}  // namespace radiafit::tools

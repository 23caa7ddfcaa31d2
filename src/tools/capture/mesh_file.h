#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "capture/mesh_placement.h"
#include "geometry/mesh.h"

namespace radiafit::tools {

/// How a welded mesh's faces are turned, degenerate ones left out.
struct Orientation {
    double signed_volume = 0;      ///< below 0: of a closed mesh, faces turn inward
    bool closed = false;           ///< each edge has two faces, turned alike
    size_t border_edges = 0;       ///< of one face
    size_t disagreeing_edges = 0;  ///< of two faces turned against each other
    size_t crowded_edges = 0;      ///< of three faces or more
};

/// A mesh as a fit needs it, and what was met on the way.
struct MeshFile {
    Mesh mesh;
    Vec3d origin = Vec3d::Zero();  ///< the placed mesh is mesh + origin; to be taken from cameras too
    Orientation orientation;
    std::vector<std::string> notes;    ///< defects, counted, one line each; empty for a clean file
    std::vector<std::string> remarks;  ///< no cause to worry
};

/// Whether the origin may move: where 32-bit floats, at the largest coordinate, have steps above 1e-5 of the mesh's
/// extent, to the middle of the mesh (in whole units of its extent's power of ten).
enum class Origin { kept, moved };

/// Reads PLY (text, binary of either byte order), OBJ, STL (text, binary), GLB and glTF. All objects of the file are
/// merged; polygons become triangles in their own plane, around their first corner where that fills them; positions are
/// placed in double, then rounded to floats; vertices are welded where their positions are equal in every bit (so that
/// texture seams don't cut the surface), in order of first appearance. Points, lines, normals, texture coordinates and
/// materials are left out. Faces of a mirrored mesh are turned over, so that they stay outward.
/// Throws UserError that names file (text: line) and cure for anything missing, unreadable, of another format,
/// malformed, cut, out of range or not finite, for a mesh without triangles, and, with the origin kept, for one so far
/// away that floats have steps above 1e-2 of its extent.
MeshFile read_mesh_file(const std::filesystem::path& file, const MeshPlacement& placement = {},
                        Origin origin = Origin::kept);

Orientation find_orientation(const Mesh& mesh);

/// Merges vertices of bitwise equal position (-0 equals 0); exported for tests. Returns the number merged away.
size_t weld_positions(Mesh& mesh);

}  // namespace radiafit::tools

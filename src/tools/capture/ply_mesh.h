#pragma once
#include <filesystem>
#include <string>

#include "capture/raw_mesh.h"

namespace radiafit::tools {

/// The surface in the bytes of a PLY file, in text or binary of either byte order: x, y, z of the element "vertex" and
/// the list "vertex_indices" or "vertex_index" of the elements "face" and "tristrips" (strips of triangles, -1 between
/// them), of any types, in the file's order; all else is passed over. Takes memory in proportion to the content.
/// Throws UserError that names file, place and cure: malformed, cut, bytes after the last entry, an index out of range,
/// a position that is not finite.
RawMesh read_ply_mesh(const std::filesystem::path& file, std::string content);

}  // namespace radiafit::tools

#pragma once
#include <filesystem>
#include <string>

#include "capture/raw_mesh.h"

namespace radiafit::tools {

/// The surface in the bytes of an STL file: binary where its length is the one that its count of triangles demands,
/// even if it begins with "solid"; else text. Each triangle has vertices of its own; normals are left out.
/// Throws UserError that names file, line or triangle and cure: malformed, cut, a position that is not finite.
RawMesh read_stl_mesh(const std::filesystem::path& file, std::string content);

}  // namespace radiafit::tools

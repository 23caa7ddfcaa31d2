#pragma once
#include <filesystem>
#include <string>

#include "capture/raw_mesh.h"

namespace radiafit::tools {

/// The surface in the bytes of an OBJ file: v and f lines, all objects and groups as one; vertices are in the order
/// in which faces first use them. Takes memory in proportion to the text.
/// Throws UserError that names file, line and cure: malformed, not finite, a reference to a vertex that does not exist.
RawMesh read_obj_mesh(const std::filesystem::path& file, std::string text);

}  // namespace radiafit::tools

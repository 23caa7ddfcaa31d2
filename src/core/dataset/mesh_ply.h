#pragma once
#include <filesystem>
#include <string>

#include "geometry/mesh.h"

namespace radiafit {

/// Writes binary little-endian PLY: float x, y, z per vertex; uchar count (3) and uint indices per face.
/// Throws UserError when the file cannot be written.
void write_ply(const Mesh& mesh, const std::filesystem::path& path, const std::string& comment = "");

/// Reads what write_ply() writes (comments and the type names of other writers included), not PLY at large: capture/
/// has a reader for that. The mesh is checked. Throws UserError that names the file and the cure.
Mesh read_ply(const std::filesystem::path& path);

}  // namespace radiafit

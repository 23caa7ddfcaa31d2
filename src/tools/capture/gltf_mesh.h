#pragma once
#include <filesystem>
#include <string>

#include "capture/raw_mesh.h"

namespace radiafit::tools {

/// The surface in the bytes of a GLB or glTF 2.0 file: the triangles, strips and fans of all meshes of the default
/// scene, moved by their nodes; buffers within the file, as base64, or in files beside it. Positions of floats, or
/// quantized as KHR_mesh_quantization does. Takes memory in proportion to the buffers.
/// Throws UserError that names file, place and cure: malformed, cut, compressed (Draco, meshopt), sparse positions,
/// another required extension, an index out of range, a position that is not finite.
RawMesh read_gltf_mesh(const std::filesystem::path& file, std::string content);

}  // namespace radiafit::tools

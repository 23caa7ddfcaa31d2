#pragma once
#include <filesystem>

namespace radiafit::tools {

struct PreviewInput {
    std::filesystem::path model;  ///< a COLMAP model of undistorted photographs; with its points where there is no mesh
    std::filesystem::path images;  ///< folder of these photographs
    std::filesystem::path mesh;    ///< in the model's frame; empty: the model's points are drawn
};

/// Writes a PNG: above, three photographs taken from far apart; below, what is known of the object, from the same
/// places. Of points, every one; of a mesh, faces lit from the camera, and its borders in red. Throws UserError.
void write_preview(const PreviewInput& input, const std::filesystem::path& out);

}  // namespace radiafit::tools

#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "geometry/camera.h"

namespace radiafit {

/// One registered photograph of a COLMAP model. COLMAP's conventions are Camera's own.
struct ColmapImage {
    std::string name;  ///< as COLMAP stores it, relative to the images folder; may hold a subfolder
    Camera camera;     ///< of the whole photograph
};

struct ColmapModel {
    std::filesystem::path cameras_file, images_file;  ///< what was read, for messages
    std::vector<ColmapImage> images;                  ///< sorted by name
};

/// Reads cameras and images of the COLMAP model in `folder`: binary if cameras.bin and images.bin stand there (as
/// COLMAP itself prefers), else text. Only SIMPLE_PINHOLE and PINHOLE cameras, that is, undistorted photographs.
/// Throws UserError that names the file (text: and the line) for anything missing, malformed, truncated, not finite,
/// zero quaternions, names or camera ids given twice, and images of unknown cameras.
ColmapModel read_colmap(const std::filesystem::path& folder);

}  // namespace radiafit

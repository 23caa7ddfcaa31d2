#pragma once
#include <filesystem>

#include "capture/calibration.h"

namespace radiafit::tools {

/// Reads poses_bounds.npy as LLFF writes it: a row of 17 numbers per photograph, of which the first 15 are a matrix of
/// 3 rows and 5 columns: the camera's axes down, right and back in the world, its centre, and height, width and focal
/// length in pixels. The principal point is the image's middle. The last two, bounds of depth, are passed over.
/// Rows belong to the pictures of `images` sorted by name. Throws UserError that names file and row for anything
/// missing, malformed or not finite, and for another number of pictures than rows.
Calibration read_llff(const std::filesystem::path& file, const std::filesystem::path& images);

}  // namespace radiafit::tools

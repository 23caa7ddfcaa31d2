#pragma once
#include <filesystem>

#include "capture/calibration.h"

namespace radiafit::tools {

/// What to do with cameras that are no pinholes: those with distortion, and fisheyes.
enum class Lenses { refused, taken };

/// Reads cameras and images of the COLMAP model in `folder`: binary if cameras.bin and images.bin are there (as
/// COLMAP itself prefers), else text. Cameras SIMPLE_PINHOLE and PINHOLE, and those with radial and tangential
/// distortion (SIMPLE_RADIAL, RADIAL, OPENCV, FULL_OPENCV) whose coefficients are all zero, become pinholes. With
/// Lenses::taken those with distortion, SIMPLE_RADIAL_FISHEYE, RADIAL_FISHEYE, OPENCV_FISHEYE, THIN_PRISM_FISHEYE and
/// FOV get a lens. COLMAP's conventions are those of Camera. Throws UserError that names the file (text: and the line)
/// for anything missing, malformed, truncated, not finite, zero quaternions, names or camera ids given twice, and
/// images of unknown cameras.
Calibration read_colmap(const std::filesystem::path& folder, Lenses lenses = Lenses::refused);

}  // namespace radiafit::tools

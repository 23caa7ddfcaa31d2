#pragma once
#include <string>

#include "capture/lamp_calibration.h"

namespace radiafit::tools {

/// lamps.png (docs/formats.md), as the file's bytes: the brightest light of all images, the spheres' outlines on it,
/// and beside it each sphere enlarged, with the highlights that were found on it. calibration: by spheres.
std::string lamp_picture(const LampCalibration& calibration);

}  // namespace radiafit::tools

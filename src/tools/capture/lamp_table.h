#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "capture/lamp_calibration.h"

namespace radiafit::tools {

/// lamps.csv (docs/formats.md): calibrated lamps, and how sure they are. names: [calibration.images] of the images.
std::string lamp_table(const LampCalibration& calibration, const std::vector<std::string>& names);

}  // namespace radiafit::tools

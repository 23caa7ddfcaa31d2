#pragma once
#include <cstdint>
#include <filesystem>
#include <vector>

#include "base/linear.h"
#include "capture/calibration.h"

namespace radiafit::tools {

/// A point that several photographs show.
struct SparsePoint {
    Vec3d position;
    double error = 0;              ///< mean distance, pixels, of its projections from where the photographs show it
    std::vector<uint32_t> images;  ///< those that show it: places in the calibration's list, ascending, each once
};

/// Reads points3D.bin or points3D.txt beside the cameras and images that `calibration` was read from
/// (capture/colmap.h), in the same form. A track of images that the model lacks, or none, is a UserError, as is
/// anything missing, malformed, cut or not finite; it names the file (text: and the line).
std::vector<SparsePoint> read_colmap_points(const std::filesystem::path& folder, const Calibration& calibration);

}  // namespace radiafit::tools

#pragma once
#include <filesystem>

#include "capture/calibration.h"

namespace radiafit::tools {

/// The files that hold a NeRF's cameras: transforms.json, and the held-out ones beside it.
struct TransformsFiles {
    std::filesystem::path main;  ///< transforms.json or transforms_train.json
    std::filesystem::path test;  ///< transforms_test.json beside it; empty: there is none
};

/// `model`: the file, or its folder. Throws UserError if there is none.
TransformsFiles find_transforms(const std::filesystem::path& model);

/// Reads files as NeRF, instant-ngp and nerfstudio write them: transform_matrix takes camera coordinates (x right, y
/// up, z back, as OpenGL has them) to the world. The lens is fl_x, fl_y, or camera_angle_x, camera_angle_y in radians,
/// cx, cy (default: the image's middle), w, h (default: the photograph's), and the coefficients k1 to k6, p1, p2 or
/// distortion_params, which camera_model and is_fisheye make those of a fisheye; a frame's values go before the file's.
/// Images of files.test are held out, those that are in both files, too. images: the folder to which each file_path
/// is relative; how they are found: capture/image_finder.h. Of a photograph that is not there, CalibratedImage::file is
/// empty, and so is its camera where the file does not say its size. Throws UserError that names file and frame for
/// anything missing, malformed, not finite, and for projections that are neither perspective nor fisheye.
Calibration read_transforms(const TransformsFiles& files, const std::filesystem::path& images);

}  // namespace radiafit::tools

#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "geometry/camera.h"

/// What any reader of calibrated photographs returns: COLMAP models, transforms.json, poses_bounds.npy.
namespace radiafit {

struct CalibratedImage {
    std::string name;       ///< relative to the folder of images; may hold a subfolder
    Camera camera;          ///< of the whole photograph
    bool held_out = false;  ///< the calibration itself says so
};

struct Calibration {
    std::filesystem::path cameras_file;   ///< has sizes and lenses; for messages
    std::filesystem::path images_file;    ///< names the photographs; for messages
    std::string size_cure;                ///< what to do about a photograph of another size than calibrated
    std::vector<CalibratedImage> images;  ///< sorted by name, none twice, one at least
};

}  // namespace radiafit

#pragma once
#include <vector>

#include "geometry/camera.h"
#include "image/image_file.h"

namespace radiafit::tools {

/// A photograph as stereo compares it, with its camera: one value in [0, 1] per pixel, as stored (not linear light),
/// row 0 on top.
struct GreyImage {
    Camera camera;
    std::vector<float> values;  ///< [camera.height][camera.width]
};

/// The mean of the channels. Throws SystemError for an image of another size than the camera.
GreyImage grey_of(const ImageFile& image, const Camera& camera);

/// Half as wide and high, means of 2 x 2 pixels; a last odd row or column is left out.
GreyImage halved(const GreyImage& image);

}  // namespace radiafit::tools

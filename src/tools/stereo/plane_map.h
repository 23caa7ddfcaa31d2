#pragma once
#include <vector>

#include "stereo/plane.h"

namespace radiafit::tools {

/// What a photograph shows, pixel by pixel: a small plane in its camera's coordinates.
struct PlaneMap {
    Camera camera;
    std::vector<InversePlane> planes;  ///< [camera.height][camera.width]; zero where nothing is known

    bool known(size_t pixel) const { return planes[pixel] != InversePlane::Zero(); }
    /// How many pixels are.
    size_t known_count() const {
        size_t count = 0;
        for (size_t i = 0; i < planes.size(); ++i) count += known(i);
        return count;
    }
};

}  // namespace radiafit::tools

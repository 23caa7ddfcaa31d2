#pragma once
#include <cstddef>
#include <vector>

#include "base/linear.h"

namespace radiafit::tools {

/// Some pixels of a surface, under every lamp.
struct SurfaceSamples {
    size_t images = 0;
    std::vector<Vec3d> positions;   ///< [pixels] world space
    std::vector<uint32_t> patches;  ///< [pixels] numbers of the patches that they lie in, whose pixels may err together
    std::vector<float> values;      ///< [pixels][images][3] linear light; not a number: left out (masked, clipped)

    size_t pixels() const { return positions.size(); }
    const float* at(size_t pixel, size_t image) const { return &values[3 * (pixel * images + image)]; }
};

}  // namespace radiafit::tools

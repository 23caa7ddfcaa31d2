#pragma once
#include <algorithm>
#include <cstddef>
#include <vector>

#include "base/linear.h"

namespace radiafit::tools {

/// Linear light, one number for each pixel. Places in an image are in pixels from its top left corner, x to the right
/// and y down: the first pixel's centre is at (0.5, 0.5).
struct LuminanceImage {
    int width = 0, height = 0;
    std::vector<float> values;  ///< [height][width]

    float at(int x, int y) const { return values[size_t(y) * size_t(width) + size_t(x)]; }
    /// Bilinear between pixel centres; beyond the outermost their values.
    double sample(const Vec2d& place) const {
        const double u = std::clamp(place.x() - 0.5, 0.0, width - 1.0);
        const double v = std::clamp(place.y() - 0.5, 0.0, height - 1.0);
        const int x = std::min(int(u), std::max(width - 2, 0)), y = std::min(int(v), std::max(height - 2, 0));
        const int right = std::min(x + 1, width - 1), below = std::min(y + 1, height - 1);
        const double a = u - x, b = v - y;
        return (1 - b) * ((1 - a) * double(at(x, y)) + a * double(at(right, y))) +
               b * ((1 - a) * double(at(x, below)) + a * double(at(right, below)));
    }
};

}  // namespace radiafit::tools

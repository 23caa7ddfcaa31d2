#pragma once
#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

#include "base/linear.h"
#include "geometry/light.h"

namespace radiafit::tools {

/// Images of one surface, a lamp each, so small that all of them fit into memory, and the lamps that a light file names
/// for them. World space: origin in the images' middle, x right, y up, z towards the camera; the images' plane is z =
/// 0.
struct LightStack {
    int width = 0, height = 0;
    double pixel = 1;                     ///< a pixel's side, in the unit of near lamps' places
    std::vector<std::string> names = {};  ///< [images]
    std::vector<Light> lamps = {};        ///< [images] of any intensity: strengths are found from the images
    std::vector<float> values = {};  ///< [height][width][images] linear light; not a number: left out (masked, clipped)

    size_t images() const { return lamps.size(); }
    const float* at(int x, int y) const { return &values[(size_t(y) * size_t(width) + size_t(x)) * images()]; }
    /// Half of the longer side.
    double reach() const { return 0.5 * std::max(width, height); }
    /// Of a pixel's centre, in halves of the longer side: x right, y up.
    Vec2d place(int x, int y) const { return Vec2d(x + 0.5 - 0.5 * width, 0.5 * height - y - 0.5) / reach(); }
    Vec3d direction(size_t image) const { return lamps[image].place.normalized(); }
    /// Half of the longer side over the lamp's distance. Of distant lamps, whose files may mean near ones, it is
    /// unknown, and 1 for all.
    double closeness(size_t image) const {
        return lamps[image].kind == Light::Kind::distant ? 1 : reach() * pixel / lamps[image].place.norm();
    }
};

}  // namespace radiafit::tools

#pragma once
#include <vector>

#include "lamps/light_stack.h"

namespace radiafit::tools {

/// A pixel of a LightStack, fitted as matt: value = strength of the lamp * direction . facing.
struct ReliefPixel {
    int x = 0, y = 0;
    Vec2d place = Vec2d::Zero();  ///< LightStack::place
    std::vector<float> value = {},
                       weight = {};  ///< [images] in units of the pixel's upper decile; weight 0: left out, shadow
    Vec3d facing = Vec3d::Zero();    ///< albedo times normal, in the light file's axes
    Vec3d normal() const { return facing.normalized(); }
};

/// The surface that lamps show under the directions that they are said to have: facing by robust least squares
/// (Cauchy), shadows left out, in turn with the lamps' strengths.
struct LitRelief {
    int width = 0, height = 0;
    std::vector<Vec3d> directions = {};  ///< [images]
    std::vector<double> strengths = {};  ///< [images]
    std::vector<ReliefPixel> pixels = {};
    std::vector<int> index = {};  ///< [height][width] of pixels; -1: too dark or left out
    double deviation = 0;         ///< robust standard deviation of what is left over

    const ReliefPixel* at(int x, int y) const {
        if (x < 0 || y < 0 || x >= width || y >= height) return nullptr;
        const int i = index[size_t(y) * size_t(width) + size_t(x)];
        return i < 0 ? nullptr : &pixels[size_t(i)];
    }
    double shown(const ReliefPixel& p, size_t image) const {
        return strengths[image] * directions[image].dot(p.facing);
    }
};

LitRelief fit_relief(const LightStack& stack);

}  // namespace radiafit::tools

#pragma once
#include <vector>

#include "base/range.h"
#include "eval/contestant.h"

namespace radiafit {

/// What lifts fine relief out of a picture, as viewers of RTI offer it: the fit's colours, darker, and on them the
/// highlights that a glossy surface with these normals would have (shaders/model/specular_enhancement.glsl).
struct SpecularEnhancement {
    double diffuse = 0.4, highlight = 0.7, exponent = 75;  ///< what RTIViewer begins with

    bool changes_nothing() const { return diffuse == 1 && highlight == 0; }
};

namespace limits {
constexpr Range<double> enhancement_share{0, 10};
constexpr Range<double> enhancement_exponent{1, 10000};
}  // namespace limits

/// Linear light of a place with this normal; directions as the shader has them.
Vec3f enhanced_light(const Vec3f& light, const Vec3f& normal, const Vec3f& to_lamp, const Vec3f& to_viewer,
                     const SpecularEnhancement& by);

/// `shown`, enhanced. normals: [texels] of the atlas, in world space, unit or 0. The views that it is asked for have
/// lamps. Throws std::invalid_argument unless `shown` hands out linear light and there is a normal for each texel. The
/// atlas must outlive it.
Contestant enhanced(Contestant shown, const SpecularEnhancement& by, const Atlas& atlas, std::vector<Vec3f> normals);

}  // namespace radiafit

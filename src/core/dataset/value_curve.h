#pragma once
#include <string>
#include <utility>
#include <vector>

#include "base/linear.h"

namespace radiafit {

/// What of light a model is fitted to. A curve brings errors in the dark and in the light nearer to how they look.
enum class ValueCurve {
    linear,
    root,  ///< its square root
    srgb   ///< as sRGB pictures store it, white = 1
};
const std::vector<std::pair<std::string, ValueCurve>>& value_curves();  ///< by their names
std::string name_of(ValueCurve curve);
/// Odd functions, which go on above 1.
float on_curve(ValueCurve curve, float light);
float from_curve(ValueCurve curve, float value);
inline Vec3f on_curve(ValueCurve curve, const Vec3f& light) {
    return {on_curve(curve, light[0]), on_curve(curve, light[1]), on_curve(curve, light[2])};
}
inline Vec3f from_curve(ValueCurve curve, const Vec3f& value) {
    return {from_curve(curve, value[0]), from_curve(curve, value[1]), from_curve(curve, value[2])};
}

}  // namespace radiafit

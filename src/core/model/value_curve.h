#pragma once
#include <string>
#include <utility>
#include <vector>

#include "base/linear.h"

namespace radiafit {

/// sRGB's transfer functions (IEC 61966-2-1); the same curve goes on above 1, and f(-x) = -f(x).
double srgb_decode(double stored);
double srgb_encode(double linear);
float srgb_decode(float stored);  ///< the same in floats, which are faster
float srgb_encode(float linear);

/// What of light a model is fitted to. A curve brings errors in the dark and in the light nearer to how they look. Its
/// number is CURVE of shaders/view/curve.glsl.
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
/// What a standard deviation of values is of the light, channel by channel.
inline Vec3f deviation_of_light(ValueCurve curve, const Vec3f& value, const Vec3f& deviation) {
    return (from_curve(curve, value + deviation) - from_curve(curve, value - deviation)) / 2;
}

}  // namespace radiafit

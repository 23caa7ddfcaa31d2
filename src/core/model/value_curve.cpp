#include "model/value_curve.h"

#include <algorithm>
#include <cmath>

namespace radiafit {

double srgb_decode(double stored) {
    const double x = std::abs(stored);
    return std::copysign(x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4), stored);
}

double srgb_encode(double linear) {
    const double x = std::abs(linear);
    return std::copysign(x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055, linear);
}

float srgb_decode(float stored) {
    const float x = std::abs(stored);
    return std::copysign(x <= 0.04045f ? x / 12.92f : std::pow((x + 0.055f) / 1.055f, 2.4f), stored);
}

float srgb_encode(float linear) {
    const float x = std::abs(linear);
    return std::copysign(x <= 0.0031308f ? 12.92f * x : 1.055f * std::pow(x, 1 / 2.4f) - 0.055f, linear);
}

const std::vector<std::pair<std::string, ValueCurve>>& value_curves() {
    static const std::vector<std::pair<std::string, ValueCurve>> curves = {
        {"srgb", ValueCurve::srgb}, {"root", ValueCurve::root}, {"linear", ValueCurve::linear}};
    return curves;
}

std::string name_of(ValueCurve curve) {
    return std::ranges::find(value_curves(), curve, &std::pair<std::string, ValueCurve>::second)->first;
}

float on_curve(ValueCurve curve, float light) {
    if (curve == ValueCurve::root) return std::copysign(std::sqrt(std::abs(light)), light);
    return curve == ValueCurve::srgb ? srgb_encode(light) : light;
}

float from_curve(ValueCurve curve, float value) {
    if (curve == ValueCurve::root) return value * std::abs(value);
    return curve == ValueCurve::srgb ? srgb_decode(value) : value;
}

}  // namespace radiafit

#include "dataset/value_curve.h"

#include <algorithm>
#include <cmath>

#include "dataset/dataset.h"

namespace radiafit {

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
    return curve == ValueCurve::srgb ? float(srgb_encode(double(light))) : light;
}

float from_curve(ValueCurve curve, float value) {
    if (curve == ValueCurve::root) return value * std::abs(value);
    return curve == ValueCurve::srgb ? float(srgb_decode(double(value))) : value;
}

}  // namespace radiafit

#include "model/value_curve.h"

#include <algorithm>
#include <cmath>

namespace radiafit {

namespace {

template <class Real>
Real decoded(Real stored) {
    const Real x = std::abs(stored);
    const Real linear = x <= Real(0.04045) ? x / Real(12.92) : std::pow((x + Real(0.055)) / Real(1.055), Real(2.4));
    return std::copysign(linear, stored);
}

template <class Real>
Real encoded(Real linear) {
    const Real x = std::abs(linear);
    const Real stored =
        x <= Real(0.0031308) ? Real(12.92) * x : Real(1.055) * std::pow(x, Real(1) / Real(2.4)) - Real(0.055);
    return std::copysign(stored, linear);
}

}  // namespace

double srgb_decode(double stored) { return decoded(stored); }
double srgb_encode(double linear) { return encoded(linear); }
float srgb_decode(float stored) { return decoded(stored); }
float srgb_encode(float linear) { return encoded(linear); }

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

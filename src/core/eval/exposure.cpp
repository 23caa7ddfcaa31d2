#include "eval/exposure.h"

#include <cmath>

namespace radiafit {
namespace {

// sRGB's curve in a form whose only power of the exposure leaves the loop: 1.055 s^(1/2.4) x^(1/2.4) - 0.055.
class ExposureError {
public:
    ExposureError(Encoding encoding, const std::vector<float>& light, const std::vector<float>& photograph)
        : srgb_(encoding == Encoding::u8_srgb), light_(light), photograph_(photograph) {
        if (!srgb_) return;
        root_.resize(light.size());
        for (size_t i = 0; i < light.size(); ++i) root_[i] = light[i] > 0 ? std::pow(light[i], 1 / 2.4f) : 0;
    }

    double at(double stops) const {
        const auto s = float(std::exp2(stops));
        const auto root = float(1.055 * std::pow(std::exp2(stops), 1 / 2.4));
        double sum = 0;
        for (size_t i = 0; i < light_.size(); ++i) {
            const float x = s * light_[i];
            float value = x;
            if (srgb_) value = x <= 0.0031308f ? 12.92f * x : root * root_[i] - 0.055f;
            value = value < 0 ? 0 : value > 1 ? 1 : value;
            const float difference = value - photograph_[i];
            sum += double(difference * difference);
        }
        return sum;
    }

private:
    bool srgb_;
    const std::vector<float>& light_;
    const std::vector<float>& photograph_;
    std::vector<float> root_;
};

}  // namespace

float clamped(float value) {
    if (!std::isfinite(value)) return NAN;
    return value < 0 ? 0 : value > 1 ? 1 : value;
}

float exposed(Encoding encoding, double exposure, double light) {
    return clamped(float(encode(encoding, exposure * light)));
}

double find_exposure(Encoding encoding, const std::vector<float>& light, const std::vector<float>& photograph,
                     double around) {
    const ExposureError error(encoding, light, photograph);
    const double center = std::log2(around);
    // Clamping may make more than one valley: look at every half stop, then close in on the lowest.
    double best = center, lowest = error.at(center);
    if (!std::isfinite(lowest)) return around;
    for (int k = 1; k <= 12; ++k)
        for (const double stops : {center - 0.5 * k, center + 0.5 * k}) {
            const double e = error.at(stops);
            if (e < lowest) lowest = e, best = stops;
        }
    const double golden = 0.6180339887498949;
    double low = best - 0.5, high = best + 0.5;
    double a = high - golden * (high - low), b = low + golden * (high - low);
    double at_a = error.at(a), at_b = error.at(b);
    while (high - low > 1e-5) {
        if (at_a < at_b) {
            high = b, b = a, at_b = at_a;
            a = high - golden * (high - low), at_a = error.at(a);
        } else {
            low = a, a = b, at_a = at_b;
            b = low + golden * (high - low), at_b = error.at(b);
        }
    }
    const double middle = 0.5 * (low + high);
    return std::exp2(error.at(middle) < lowest ? middle : best);
}

}  // namespace radiafit

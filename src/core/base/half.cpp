#include "base/half.h"

#include <bit>

namespace radiafit {
namespace {

constexpr uint32_t half_infinity = 0x7c00;
constexpr uint32_t half_quiet = 0x0200;
constexpr uint32_t float_infinity = 0x7f800000;

/// Magnitude of x in units of half's last place, in two parts: `kept` is the half's bits without sign, rounded
/// down, and `lost` what was cut off, left-aligned in 32 bits (so 0x80000000 is exactly one half of a unit).
struct Cut {
    uint32_t kept;
    uint32_t lost;
};

Cut cut(uint32_t magnitude) {
    const uint32_t exponent = magnitude >> 23;
    if (exponent >= 113) {  // normal as a half: rebias the exponent by 127 − 15, drop 13 bits
        return {(magnitude >> 13) - (112u << 10), magnitude << 19};
    }
    // Subnormal as a half: units of 2⁻²⁴, the leading one made explicit. shift is 14 at exponent 112.
    const uint32_t mantissa = (magnitude & 0x007fffff) | (exponent == 0 ? 0u : 0x00800000u);
    const uint32_t shift = 126 - exponent;
    if (shift > 31) return {0, mantissa == 0 ? 0u : 1u};  // far below half a unit
    return {mantissa >> shift, mantissa << (32 - shift)};
}

/// The cases both roundings share: returns true with the result in `half` for infinities and NaN.
bool is_special(uint32_t magnitude, uint32_t& half) {
    if (magnitude < float_infinity) return false;
    half = half_infinity;
    if (magnitude > float_infinity) half |= half_quiet | (magnitude >> 13 & 0x3ff);
    return true;
}

}  // namespace

uint16_t half_from_float_software(float x) {
    const auto bits = std::bit_cast<uint32_t>(x);
    const uint32_t sign = bits >> 16 & 0x8000;
    const uint32_t magnitude = bits & 0x7fffffff;
    uint32_t half = 0;
    if (!is_special(magnitude, half)) {
        if (magnitude >= 0x477ff000) {  // 65520: halfway between 65504 and the first power of two beyond
            half = half_infinity;
        } else {
            const auto [kept, lost] = cut(magnitude);
            const bool up = lost > 0x80000000 || (lost == 0x80000000 && (kept & 1) != 0);
            half = kept + (up ? 1 : 0);  // a carry runs into the exponent, which is what it should do
        }
    }
    return static_cast<uint16_t>(sign | half);
}

uint16_t half_from_float_truncated_software(float x) {
    const auto bits = std::bit_cast<uint32_t>(x);
    const uint32_t sign = bits >> 16 & 0x8000;
    const uint32_t magnitude = bits & 0x7fffffff;
    uint32_t half = 0;
    if (!is_special(magnitude, half)) half = magnitude >= 0x47800000 ? half_infinity - 1 : cut(magnitude).kept;
    return static_cast<uint16_t>(sign | half);
}

float float_from_half_software(uint16_t half) {
    const uint32_t sign = (half & 0x8000u) << 16;
    const uint32_t exponent = half >> 10 & 0x1f;
    const uint32_t mantissa = half & 0x3ff;
    if (exponent == 31) {
        const uint32_t quiet = mantissa == 0 ? 0u : 0x00400000u;
        return std::bit_cast<float>(sign | float_infinity | quiet | mantissa << 13);
    }
    if (exponent == 0) {
        const float magnitude = static_cast<float>(mantissa) * 0x1p-24f;
        return sign == 0 ? magnitude : -magnitude;
    }
    return std::bit_cast<float>(sign | (exponent + 112) << 23 | mantissa << 13);
}

}  // namespace radiafit

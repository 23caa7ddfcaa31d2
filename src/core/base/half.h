#pragma once
#include <cstdint>
#ifdef __F16C__
#include <immintrin.h>
#else
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#endif

/// IEEE 754 binary16. Bits are carried as uint16_t; arithmetic is done in float. A signalling NaN is made quiet and
/// keeps the upper ten bits of its payload.
namespace radiafit {

/// half_from_float: round to nearest, ties to even; |x| ≥ 65520 becomes infinite.
/// half_from_float_truncated: round towards zero, as rendering into a half target does: finite values stop at ±65504.
/// float_from_half, eight_floats_from_halves: exact.
#ifdef __F16C__  // every x86-64-v3 machine: one instruction each
inline uint16_t half_from_float(float x) { return _cvtss_sh(x, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC); }
inline uint16_t half_from_float_truncated(float x) { return _cvtss_sh(x, _MM_FROUND_TO_ZERO | _MM_FROUND_NO_EXC); }
inline float float_from_half(uint16_t bits) { return _cvtsh_ss(bits); }
inline void eight_floats_from_halves(const void* halves, float* floats) {
    _mm256_storeu_ps(floats, _mm256_cvtph_ps(_mm_loadu_si128(static_cast<const __m128i*>(halves))));
}
#else
inline uint16_t half_from_float(float x) { return std::bit_cast<uint16_t>(static_cast<_Float16>(x)); }
inline float float_from_half(uint16_t bits) { return std::bit_cast<_Float16>(bits); }
inline void eight_floats_from_halves(const void* halves, float* floats) {
    std::array<uint16_t, 8> bits;
    std::memcpy(bits.data(), halves, sizeof bits);
    for (size_t i = 0; i < 8; ++i) floats[i] = float_from_half(bits[i]);
}
inline uint16_t half_from_float_truncated(float x) {
    const uint16_t nearest = half_from_float(x);
    return std::abs(float_from_half(nearest)) > std::abs(x) ? uint16_t(nearest - 1) : nearest;
}
#endif

}  // namespace radiafit

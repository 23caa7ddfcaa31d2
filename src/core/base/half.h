#pragma once
#include <cstdint>

/// IEEE 754 binary16. Bits are carried as uint16_t; arithmetic is done in float.
/// With F16C (every x86-64-v3 machine) the plain names compile to one instruction; the `_software` ones are the same
/// function for every value, NaN included: a signalling NaN is made quiet and keeps the upper ten bits of its payload.
namespace radiafit {

/// Largest finite half.
constexpr float half_max = 65504.0f;

/// Round to nearest, ties to even; |x| ≥ 65520 becomes infinite.
uint16_t half_from_float(float x);
/// Round towards zero, as rendering into a half target does: finite values stop at ±65504.
uint16_t half_from_float_truncated(float x);
/// Exact.
float float_from_half(uint16_t bits);

uint16_t half_from_float_software(float x);
uint16_t half_from_float_truncated_software(float x);
float float_from_half_software(uint16_t bits);

/// x after a round trip through half.
inline float rounded_to_half(float x) { return float_from_half(half_from_float(x)); }
inline float truncated_to_half(float x) { return float_from_half(half_from_float_truncated(x)); }

}  // namespace radiafit

#ifdef __F16C__
#include <immintrin.h>
namespace radiafit {
inline uint16_t half_from_float(float x) { return _cvtss_sh(x, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC); }
inline uint16_t half_from_float_truncated(float x) { return _cvtss_sh(x, _MM_FROUND_TO_ZERO | _MM_FROUND_NO_EXC); }
inline float float_from_half(uint16_t bits) { return _cvtsh_ss(bits); }
}  // namespace radiafit
#else
namespace radiafit {
inline uint16_t half_from_float(float x) { return half_from_float_software(x); }
inline uint16_t half_from_float_truncated(float x) { return half_from_float_truncated_software(x); }
inline float float_from_half(uint16_t bits) { return float_from_half_software(bits); }
}  // namespace radiafit
#endif

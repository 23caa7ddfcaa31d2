#pragma once
#include <cstdint>

/// e^x and ln x of lanes side by side, V a vector of floats or doubles (GCC's vector_size), without calls. Sums and
/// products of lanes alone, so that the same text serves vectors of any width. Results go to y: what returns a vector
/// depends on the instructions that a program is compiled for.
namespace radiafit::lane_math {

/// e^x of floats within 2 units in the last place (relative error 2e-7) where e^x is a normal float; beyond, x counts
/// as the nearest such: never zero, never infinite. NaN stays NaN.
template <class V>
[[gnu::always_inline]] inline void exp_of_floats(const V& x, V& y) {
    typedef uint32_t Bits __attribute__((vector_size(sizeof(V))));
    // x = k ln 2 + r, |r| <= ln 2 / 2; ln 2 in two parts, the first with few enough bits that k times it is exact
    const V least = V{} - 87.33f, most = V{} + 88.37f;
    const V above = x < least ? least : x, bounded = most < above ? most : above;
    const V shifted = bounded * 1.44269504f + 12582912.0f;  // 1.5 * 2^23 rounds to a whole number
    const V k = shifted - 12582912.0f;
    const V r = (bounded - k * 0.693359375f) + k * 2.12194440e-4f;
    // the minimax polynomial of (e^r - 1 - r) / r^2: relative error of e^r 3.1e-9
    const V r2 = r * r;
    const V even = (1.381459861e-3f * r2 + 4.166838805e-2f) * r2 + 4.999999345e-1f;
    const V odd = 8.368716879e-3f * r2 + 1.666652063e-1f;
    const V power = (odd * r + even) * r2 + r + 1.0f;
    const Bits whole = (Bits)shifted << 23;  // what 12582912 adds is shifted out
    y = (V)((Bits)power + whole);
}

/// ln x of floats within 2 units in the last place (relative error 2e-7) for normal positive x; of any other x, some
/// finite number.
template <class V>
[[gnu::always_inline]] inline void log_of_floats(const V& x, V& y) {
    typedef uint32_t Bits __attribute__((vector_size(sizeof(V))));
    typedef int32_t Ints __attribute__((vector_size(sizeof(V))));
    // x = 2^k m, sqrt(1/2) <= m < sqrt(2)
    const Bits bits = (Bits)x, from_half = bits - 0x3f3504f3u;
    const V k = __builtin_convertvector((Ints)from_half >> 23, V);
    const V f = (V)(bits - (from_half & ~0x7fffffu)) - 1.0f;
    // the minimax polynomial of (ln(1 + f) - f + f^2 / 2) / f^3: relative error of ln(1 + f) 5.8e-9
    const V f2 = f * f, f4 = f2 * f2;
    const V low = (3.333333171e-1f + f * -2.500082103e-1f) + f2 * (2.000122688e-1f + f * -1.662335739e-1f);
    const V high = (1.420175797e-1f + f * -1.316018192e-1f) + f2 * (1.276157712e-1f + f * -7.634497869e-2f);
    const V tail = f2 * (f * (high * f4 + low) - 0.5f) - k * 2.12194440e-4f;
    y = (tail + f) + k * 0.693359375f;
}

/// e^x of doubles within 2 units in the last place where e^x is a normal double; beyond as that of floats.
template <class V>
[[gnu::always_inline]] inline void exp_of_doubles(const V& x, V& y) {
    typedef uint64_t Bits __attribute__((vector_size(sizeof(V))));
    const V least = V{} - 708.3, most = V{} + 709.4;
    const V above = x < least ? least : x, bounded = most < above ? most : above;
    const V shifted = bounded * 1.4426950408889634 + 6755399441055744.0;  // 1.5 * 2^52
    const V k = shifted - 6755399441055744.0;
    const V r = (bounded - k * 6.93147180369123816490e-1) - k * 1.90821492927058770002e-10;
    // Taylor's polynomial of (e^r - 1 - r) / r^2, up to r^11 / 13!: relative error of e^r 5e-18
    const V r2 = r * r, r4 = r2 * r2;
    const V a = (0.5 + r * 1.66666666666666667e-1) + r2 * (4.16666666666666667e-2 + r * 8.33333333333333333e-3);
    const V b = (1.38888888888888889e-3 + r * 1.98412698412698413e-4) +
                r2 * (2.48015873015873016e-5 + r * 2.75573192239858907e-6);
    const V c = (2.75573192239858907e-7 + r * 2.50521083854417188e-8) +
                r2 * (2.08767569878680990e-9 + r * 1.60590438368216146e-10);
    const V power = (r2 * (a + r4 * (b + r4 * c)) + r) + 1.0;
    const Bits whole = (Bits)shifted << 52;
    y = (V)((Bits)power + whole);
}

}  // namespace radiafit::lane_math

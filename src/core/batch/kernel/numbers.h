#pragma once
// Numbers that a model's text is compiled with where each lane holds a problem. Includes next to nothing, since it is
// compiled anew with every model (batch/kernel/problem_lanes.h).
#include <cmath>

#include "base/jet.h"
#include "base/lane_math.h"

namespace radiafit::batch {

#ifdef __AVX512F__
inline constexpr int vector_bytes = 64;
#elif defined(__AVX__)
inline constexpr int vector_bytes = 32;
#else
inline constexpr int vector_bytes = 16;
#endif

/// Comparisons give a mask, -1 where true. max, min and select treat NaN as std::max, std::min and ?: do.
template <class real>
struct Wide {
    typedef real Vector __attribute__((vector_size(vector_bytes)));
    using Mask = decltype(Vector{} < Vector{});
    static constexpr int size = vector_bytes / int(sizeof(real));
    Vector v;

    Wide() = default;  ///< holds nothing yet
    RADIAFIT_INLINE Wide(float x) : v(Vector{} + real(x)) {}
    RADIAFIT_INLINE Wide(double x) : v(Vector{} + real(x)) {}
    RADIAFIT_INLINE Wide(int x) : v(Vector{} + real(x)) {}
    RADIAFIT_INLINE explicit Wide(const Vector& x) : v(x) {}

    RADIAFIT_INLINE friend Wide operator+(const Wide& a, const Wide& b) { return Wide(a.v + b.v); }
    RADIAFIT_INLINE friend Wide operator-(const Wide& a, const Wide& b) { return Wide(a.v - b.v); }
    RADIAFIT_INLINE friend Wide operator*(const Wide& a, const Wide& b) { return Wide(a.v * b.v); }
    RADIAFIT_INLINE friend Wide operator/(const Wide& a, const Wide& b) { return Wide(a.v / b.v); }
    RADIAFIT_INLINE friend Wide operator-(const Wide& a) { return Wide(-a.v); }
    RADIAFIT_INLINE Wide& operator+=(const Wide& b) { return v += b.v, *this; }
    RADIAFIT_INLINE Wide& operator-=(const Wide& b) { return v -= b.v, *this; }
    RADIAFIT_INLINE Wide& operator*=(const Wide& b) { return v *= b.v, *this; }
    RADIAFIT_INLINE Wide& operator/=(const Wide& b) { return v /= b.v, *this; }
    RADIAFIT_INLINE friend Mask operator<(const Wide& a, const Wide& b) { return a.v < b.v; }
    RADIAFIT_INLINE friend Mask operator<=(const Wide& a, const Wide& b) { return a.v <= b.v; }
    RADIAFIT_INLINE friend Mask operator>(const Wide& a, const Wide& b) { return a.v > b.v; }
    RADIAFIT_INLINE friend Mask operator>=(const Wide& a, const Wide& b) { return a.v >= b.v; }
    RADIAFIT_INLINE friend Wide max(const Wide& a, const Wide& b) { return Wide(a.v < b.v ? b.v : a.v); }
    RADIAFIT_INLINE friend Wide min(const Wide& a, const Wide& b) { return Wide(b.v < a.v ? b.v : a.v); }
    RADIAFIT_INLINE friend Wide abs(const Wide& a) { return Wide(a.v < 0 ? -a.v : a.v); }
    RADIAFIT_INLINE static Wide select(const Mask& c, const Wide& a, const Wide& b) { return Wide(c ? a.v : b.v); }
};

template <class real>
RADIAFIT_INLINE Wide<real> sqrt(const Wide<real>& x) {
    Wide<real> y;
    for (int lane = 0; lane < Wide<real>::size; ++lane) y.v[lane] = __builtin_sqrt(x.v[lane]);
    return y;
}

// The C library's functions of several numbers, within 4 units in the last place; else one after another.
#if defined(__x86_64__) && defined(__GLIBC__)
#ifdef __AVX512F__
#define RADIAFIT_SYMBOL_F(args, name) _ZGVeN16##args##_##name##f
#define RADIAFIT_SYMBOL_D(args, name) _ZGVeN8##args##_##name
#elif defined(__AVX2__)
#define RADIAFIT_SYMBOL_F(args, name) _ZGVdN8##args##_##name##f
#define RADIAFIT_SYMBOL_D(args, name) _ZGVdN4##args##_##name
#elif defined(__AVX__)
#define RADIAFIT_SYMBOL_F(args, name) _ZGVcN8##args##_##name##f
#define RADIAFIT_SYMBOL_D(args, name) _ZGVcN4##args##_##name
#else
#define RADIAFIT_SYMBOL_F(args, name) _ZGVbN4##args##_##name##f
#define RADIAFIT_SYMBOL_D(args, name) _ZGVbN2##args##_##name
#endif
#define RADIAFIT_ONE(name)                                                                                          \
    extern "C" Wide<float>::Vector RADIAFIT_SYMBOL_F(v, name)(Wide<float>::Vector);                                 \
    extern "C" Wide<double>::Vector RADIAFIT_SYMBOL_D(v, name)(Wide<double>::Vector);                               \
    RADIAFIT_INLINE Wide<float> name(const Wide<float>& x) { return Wide<float>(RADIAFIT_SYMBOL_F(v, name)(x.v)); } \
    RADIAFIT_INLINE Wide<double> name(const Wide<double>& x) { return Wide<double>(RADIAFIT_SYMBOL_D(v, name)(x.v)); }
#define RADIAFIT_TWO(name)                                                                                   \
    extern "C" Wide<float>::Vector RADIAFIT_SYMBOL_F(vv, name)(Wide<float>::Vector, Wide<float>::Vector);    \
    extern "C" Wide<double>::Vector RADIAFIT_SYMBOL_D(vv, name)(Wide<double>::Vector, Wide<double>::Vector); \
    RADIAFIT_INLINE Wide<float> name(const Wide<float>& x, const Wide<float>& y) {                           \
        return Wide<float>(RADIAFIT_SYMBOL_F(vv, name)(x.v, y.v));                                           \
    }                                                                                                        \
    RADIAFIT_INLINE Wide<double> name(const Wide<double>& x, const Wide<double>& y) {                        \
        return Wide<double>(RADIAFIT_SYMBOL_D(vv, name)(x.v, y.v));                                          \
    }
#else
#define RADIAFIT_ONE(name)                                                                          \
    template <class real>                                                                           \
    inline Wide<real> name(const Wide<real>& x) {                                                   \
        Wide<real> y;                                                                               \
        for (int lane = 0; lane < Wide<real>::size; ++lane) y.v[lane] = real(std::name(x.v[lane])); \
        return y;                                                                                   \
    }
#define RADIAFIT_TWO(name)                                                                                     \
    template <class real>                                                                                      \
    inline Wide<real> name(const Wide<real>& a, const Wide<real>& b) {                                         \
        Wide<real> y;                                                                                          \
        for (int lane = 0; lane < Wide<real>::size; ++lane) y.v[lane] = real(std::name(a.v[lane], b.v[lane])); \
        return y;                                                                                              \
    }
#endif
RADIAFIT_ONE(log);
RADIAFIT_ONE(sin);
RADIAFIT_ONE(cos);
RADIAFIT_ONE(tan);
RADIAFIT_ONE(atan);
RADIAFIT_ONE(sinh);
RADIAFIT_ONE(cosh);
RADIAFIT_ONE(tanh);
RADIAFIT_TWO(pow);
#undef RADIAFIT_ONE
#undef RADIAFIT_TWO

RADIAFIT_INLINE Wide<float> exp(const Wide<float>& x) {
    Wide<float> y;
    lane_math::exp_of_floats(x.v, y.v);
    return y;
}
RADIAFIT_INLINE Wide<double> exp(const Wide<double>& x) {
    Wide<double> y;
    lane_math::exp_of_doubles(x.v, y.v);
    return y;
}

/// Whether a mask holds in any lane.
template <class Mask>
inline bool any_of(const Mask& mask) {
    unsigned long long words[sizeof(Mask) / 8], all = 0;
    __builtin_memcpy(words, &mask, sizeof mask);
    for (const unsigned long long word : words) all |= word;
    return all != 0;
}

// Not by comparison, since the compiler may take all numbers for finite.
inline bool is_finite(float x) {
    unsigned bits;
    __builtin_memcpy(&bits, &x, sizeof bits);
    return (bits & 0x7f800000u) != 0x7f800000u;
}
inline bool is_finite(double x) {
    unsigned long long bits;
    __builtin_memcpy(&bits, &x, sizeof bits);
    return (bits & 0x7ff0000000000000ull) != 0x7ff0000000000000ull;
}
template <class real>
inline typename Wide<real>::Mask is_finite(const Wide<real>& x) {
    using Mask = typename Wide<real>::Mask;
    using Integer = decltype(Mask{}[0] + 0);
    constexpr auto exponent = sizeof(real) == 8 ? 0x7ff0000000000000ll : 0x7f800000ll;
    const Mask bits = (Mask)x.v & (Mask{} + (Integer)exponent);
    return bits != Mask{} + (Integer)exponent;
}

}  // namespace radiafit::batch

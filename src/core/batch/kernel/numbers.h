#pragma once
// Numbers that a model's text is compiled with where each lane holds a problem: Wide, lanes side by side, and Jet, such
// numbers with their derivatives by the model's parameters (forward mode; Griewank and Walther 2008, chapter 3).
// Includes next to nothing, since it is compiled anew with every model (batch/kernel/problem_lanes.h).
#include <cmath>

#include "base/lane_math.h"

namespace radiafit::batch {

#ifdef __AVX512F__
inline constexpr int vector_bytes = 64;
#elif defined(__AVX__)
inline constexpr int vector_bytes = 32;
#else
inline constexpr int vector_bytes = 16;
#endif

#define RADIAFIT_INLINE [[gnu::always_inline]] inline

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

/// A number and its derivatives by so many parameters.
template <class number, int count>
struct Jet {
    number v, d[count];

    Jet() = default;  ///< holds nothing yet
    template <class Constant>
    RADIAFIT_INLINE Jet(Constant x) : v(x) {
#pragma GCC unroll 32
        for (int i = 0; i < count; ++i) d[i] = number(0);
    }
    /// f(a) and f(a, b), of the value f and the derivatives f' by each.
    RADIAFIT_INLINE static Jet of(const number& f, const number& slope, const Jet& a) {
        Jet y;
        y.v = f;
#pragma GCC unroll 32
        for (int i = 0; i < count; ++i) y.d[i] = slope * a.d[i];
        return y;
    }
    RADIAFIT_INLINE static Jet of(const number& f, const number& by_a, const Jet& a, const number& by_b, const Jet& b) {
        Jet y;
        y.v = f;
#pragma GCC unroll 32
        for (int i = 0; i < count; ++i) y.d[i] = by_a * a.d[i] + by_b * b.d[i];
        return y;
    }
    RADIAFIT_INLINE friend Jet operator+(const Jet& a, const Jet& b) {
        Jet y;
        y.v = a.v + b.v;
#pragma GCC unroll 32
        for (int i = 0; i < count; ++i) y.d[i] = a.d[i] + b.d[i];
        return y;
    }
    RADIAFIT_INLINE friend Jet operator-(const Jet& a, const Jet& b) {
        Jet y;
        y.v = a.v - b.v;
#pragma GCC unroll 32
        for (int i = 0; i < count; ++i) y.d[i] = a.d[i] - b.d[i];
        return y;
    }
    RADIAFIT_INLINE friend Jet operator-(const Jet& a) { return of(-a.v, number(-1), a); }
    RADIAFIT_INLINE friend Jet operator*(const Jet& a, const Jet& b) { return of(a.v * b.v, b.v, a, a.v, b); }
    RADIAFIT_INLINE friend Jet operator/(const Jet& a, const Jet& b) {
        const number over = number(1) / b.v, y = a.v * over;
        return of(y, over, a, -y * over, b);
    }
    RADIAFIT_INLINE Jet& operator+=(const Jet& b) { return *this = *this + b; }
    RADIAFIT_INLINE Jet& operator-=(const Jet& b) { return *this = *this - b; }
    RADIAFIT_INLINE Jet& operator*=(const Jet& b) { return *this = *this * b; }
    RADIAFIT_INLINE Jet& operator/=(const Jet& b) { return *this = *this / b; }
    RADIAFIT_INLINE friend auto operator<(const Jet& a, const Jet& b) { return a.v < b.v; }
    RADIAFIT_INLINE friend auto operator<=(const Jet& a, const Jet& b) { return a.v <= b.v; }
    RADIAFIT_INLINE friend auto operator>(const Jet& a, const Jet& b) { return a.v > b.v; }
    RADIAFIT_INLINE friend auto operator>=(const Jet& a, const Jet& b) { return a.v >= b.v; }
    template <class Mask>
    RADIAFIT_INLINE static Jet select(const Mask& c, const Jet& a, const Jet& b) {
        Jet y;
        y.v = number::select(c, a.v, b.v);
#pragma GCC unroll 32
        for (int i = 0; i < count; ++i) y.d[i] = number::select(c, a.d[i], b.d[i]);
        return y;
    }
    RADIAFIT_INLINE friend Jet max(const Jet& a, const Jet& b) { return select(a.v < b.v, b, a); }
    RADIAFIT_INLINE friend Jet min(const Jet& a, const Jet& b) { return select(b.v < a.v, b, a); }
    RADIAFIT_INLINE friend Jet abs(const Jet& a) { return select(a.v < number(0), -a, a); }
    RADIAFIT_INLINE friend Jet sqrt(const Jet& a) {
        const number y = sqrt(a.v);
        return of(y, number::select(y > number(0), number(0.5) / y, number(0)), a);
    }
    RADIAFIT_INLINE friend Jet exp(const Jet& a) {
        const number y = exp(a.v);
        return of(y, y, a);
    }
    RADIAFIT_INLINE friend Jet log(const Jet& a) { return of(log(a.v), number(1) / a.v, a); }
    RADIAFIT_INLINE friend Jet sin(const Jet& a) { return of(sin(a.v), cos(a.v), a); }
    RADIAFIT_INLINE friend Jet cos(const Jet& a) { return of(cos(a.v), -sin(a.v), a); }
    RADIAFIT_INLINE friend Jet tan(const Jet& a) {
        const number y = tan(a.v);
        return of(y, number(1) + y * y, a);
    }
    RADIAFIT_INLINE friend Jet atan(const Jet& a) { return of(atan(a.v), number(1) / (number(1) + a.v * a.v), a); }
    RADIAFIT_INLINE friend Jet sinh(const Jet& a) { return of(sinh(a.v), cosh(a.v), a); }
    RADIAFIT_INLINE friend Jet cosh(const Jet& a) { return of(cosh(a.v), sinh(a.v), a); }
    RADIAFIT_INLINE friend Jet tanh(const Jet& a) {
        const number y = tanh(a.v);
        return of(y, number(1) - y * y, a);
    }
    /// a^b with a > 0; of a = 0 derivatives that are not finite count as 0, as that of sqrt does.
    RADIAFIT_INLINE friend Jet pow(const Jet& a, const Jet& b) {
        const number y = pow(a.v, b.v);
        const number by_exponent = number::select(a.v > number(0), y * log(a.v), number(0));
        const number by_base =
            number::select((a.v > number(0)) | (b.v >= number(1)), b.v * pow(a.v, b.v - number(1)), number(0));
        return of(y, by_base, a, by_exponent, b);
    }
};

}  // namespace radiafit::batch

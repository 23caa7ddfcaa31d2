#pragma once
// Includes next to nothing, since models' texts are compiled with it anew (batch/kernel/problem_lanes.h).
#include <cmath>

#include "base/select_number.h"

#define RADIAFIT_INLINE [[gnu::always_inline]] inline

namespace radiafit {

/// A number and its derivatives by so many parameters (forward mode; Griewank and Walther 2008, chapter 3). number:
/// float, double, lanes of these, or a Jet, which gives second derivatives.
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
        y.v = select_number<number>(c, a.v, b.v);
#pragma GCC unroll 32
        for (int i = 0; i < count; ++i) y.d[i] = select_number<number>(c, a.d[i], b.d[i]);
        return y;
    }
    RADIAFIT_INLINE friend Jet max(const Jet& a, const Jet& b) { return select(a.v < b.v, b, a); }
    RADIAFIT_INLINE friend Jet min(const Jet& a, const Jet& b) { return select(b.v < a.v, b, a); }
    RADIAFIT_INLINE friend Jet abs(const Jet& a) { return select(a.v < number(0), -a, a); }
    RADIAFIT_INLINE friend Jet sqrt(const Jet& a) {
        using std::sqrt;
        const number y = sqrt(a.v);
        return of(y, select_number<number>(y > number(0), number(0.5) / y, number(0)), a);
    }
    RADIAFIT_INLINE friend Jet exp(const Jet& a) {
        using std::exp;
        const number y = exp(a.v);
        return of(y, y, a);
    }
    RADIAFIT_INLINE friend Jet log(const Jet& a) {
        using std::log;
        return of(log(a.v), number(1) / a.v, a);
    }
    RADIAFIT_INLINE friend Jet sin(const Jet& a) {
        using std::sin, std::cos;
        return of(sin(a.v), cos(a.v), a);
    }
    RADIAFIT_INLINE friend Jet cos(const Jet& a) {
        using std::cos, std::sin;
        return of(cos(a.v), -sin(a.v), a);
    }
    RADIAFIT_INLINE friend Jet tan(const Jet& a) {
        using std::tan;
        const number y = tan(a.v);
        return of(y, number(1) + y * y, a);
    }
    RADIAFIT_INLINE friend Jet atan(const Jet& a) {
        using std::atan;
        return of(atan(a.v), number(1) / (number(1) + a.v * a.v), a);
    }
    RADIAFIT_INLINE friend Jet sinh(const Jet& a) {
        using std::sinh, std::cosh;
        return of(sinh(a.v), cosh(a.v), a);
    }
    RADIAFIT_INLINE friend Jet cosh(const Jet& a) {
        using std::cosh, std::sinh;
        return of(cosh(a.v), sinh(a.v), a);
    }
    RADIAFIT_INLINE friend Jet tanh(const Jet& a) {
        using std::tanh;
        const number y = tanh(a.v);
        return of(y, number(1) - y * y, a);
    }
    /// a^b with a > 0; of a = 0 derivatives that are not finite count as 0, as that of sqrt does.
    RADIAFIT_INLINE friend Jet pow(const Jet& a, const Jet& b) {
        using std::pow, std::log;
        const number y = pow(a.v, b.v);
        const number by_exponent = select_number<number>(a.v > number(0), y * log(a.v), number(0));
        const number by_base =
            select_number<number>((a.v > number(0)) | (b.v >= number(1)), b.v * pow(a.v, b.v - number(1)), number(0));
        return of(y, by_base, a, by_exponent, b);
    }
};

}  // namespace radiafit

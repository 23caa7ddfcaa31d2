#pragma once
#include <cstdint>
#include <type_traits>

#include "base/lanes.h"

namespace radiafit {

namespace detail {
#ifdef __AVX512F__
constexpr int instructions = 3;
#elif defined(__AVX__)
constexpr int instructions = 2;
#else
constexpr int instructions = 1;
#endif
}  // namespace detail

/// Eight numbers that go through arithmetic side by side: `real` of the shared texts where eight problems are lanes.
/// Which instructions a program is compiled for is part of the type, since it decides how one is passed. Comparisons
/// give a mask; max, min and select treat NaN as std::max, std::min and ?: do.
template <class real, int instructions = detail::instructions>
struct PackOf {
    static constexpr int size = 8;
    using Vector = PairLanes<real>;
    /// Eight truths.
    struct Mask {
        decltype(Vector{} < Vector{}) bits;
        bool operator[](int lane) const { return bits[lane] != 0; }
        void set(int lane, bool x) { bits[lane] = x ? -1 : 0; }
        friend Mask operator&(const Mask& a, const Mask& b) { return {a.bits & b.bits}; }
        friend Mask operator|(const Mask& a, const Mask& b) { return {a.bits | b.bits}; }
    };
    Vector v;

    PackOf() = default;  ///< holds nothing yet; PackOf{} is zero
    PackOf(real x) : v{x, x, x, x, x, x, x, x} {}
    template <class Other>
    requires(std::is_arithmetic_v<Other> && !std::is_same_v<Other, real>) explicit PackOf(Other x) : PackOf(real(x)) {}
    explicit PackOf(const Vector& x) : v(x) {}

    real operator[](int lane) const { return v[lane]; }
    void set(int lane, real x) { v[lane] = x; }

    friend PackOf operator+(const PackOf& a, const PackOf& b) { return PackOf(a.v + b.v); }
    friend PackOf operator-(const PackOf& a, const PackOf& b) { return PackOf(a.v - b.v); }
    friend PackOf operator*(const PackOf& a, const PackOf& b) { return PackOf(a.v * b.v); }
    friend PackOf operator/(const PackOf& a, const PackOf& b) { return PackOf(a.v / b.v); }
    friend PackOf operator-(const PackOf& a) { return PackOf(-a.v); }
    PackOf& operator+=(const PackOf& b) { return v += b.v, *this; }
    PackOf& operator-=(const PackOf& b) { return v -= b.v, *this; }
    PackOf& operator*=(const PackOf& b) { return v *= b.v, *this; }

    friend Mask operator<(const PackOf& a, const PackOf& b) { return {a.v < b.v}; }
    friend Mask operator<=(const PackOf& a, const PackOf& b) { return {a.v <= b.v}; }
    friend Mask operator>(const PackOf& a, const PackOf& b) { return {a.v > b.v}; }
    friend Mask operator>=(const PackOf& a, const PackOf& b) { return {a.v >= b.v}; }
    friend PackOf max(const PackOf& a, const PackOf& b) { return PackOf(a.v < b.v ? b.v : a.v); }
    friend PackOf min(const PackOf& a, const PackOf& b) { return PackOf(b.v < a.v ? b.v : a.v); }
    static PackOf select(const Mask& c, const PackOf& a, const PackOf& b) { return PackOf(c.bits ? a.v : b.v); }
    friend PackOf sqrt(PackOf x) {
        for (int lane = 0; lane < size; ++lane) x.v[lane] = std::sqrt(x.v[lane]);
        return x;
    }
    friend PackOf log(PackOf x) requires(std::is_same_v<real, double>) {
        for (int lane = 0; lane < size; ++lane) x.v[lane] = std::log(x.v[lane]);
        return x;
    }
    friend void set_lane(PackOf& to, int lane, real x) { to.set(lane, x); }
    /// Lane by lane a where `condition` is not zero, b elsewhere.
    friend PackOf select_nonzero(const PackOf& condition, const PackOf& a, const PackOf& b) {
        return PackOf(condition.v != 0 ? a.v : b.v);
    }
};

using Pack = PackOf<float>;
using WidePack = PackOf<double>;

inline WidePack widen(const Pack& x) { return WidePack(__builtin_convertvector(x.v, WidePack::Vector)); }
inline Pack narrow(const WidePack& x) { return Pack(__builtin_convertvector(x.v, Pack::Vector)); }

namespace detail {
using PackBits = uint32_t __attribute__((vector_size(32)));
using PackInts = int32_t __attribute__((vector_size(32)));
}  // namespace detail

/// e^x within 2 units in the last place (relative error 2e-7) where e^x is a normal float; beyond, x counts as the
/// nearest such: never zero, never infinite. NaN stays NaN.
inline Pack exp(const Pack& x) {
    // x = k ln 2 + r, |r| <= ln 2 / 2; ln 2 in two parts, the first with few enough bits that k times it is exact
    const Pack bounded = min(max(x, Pack(-87.33f)), Pack(88.37f));
    const Pack shifted = bounded * Pack(1.44269504f) + Pack(12582912.0f);  // 1.5 * 2^23 rounds to a whole number
    const Pack k = shifted - Pack(12582912.0f);
    const Pack r = (bounded - k * Pack(0.693359375f)) + k * Pack(2.12194440e-4f);
    // the minimax polynomial of (e^r - 1 - r) / r^2: relative error of e^r 3.1e-9
    const Pack r2 = r * r;
    const Pack even = (Pack(1.381459861e-3f) * r2 + Pack(4.166838805e-2f)) * r2 + Pack(4.999999345e-1f);
    const Pack odd = Pack(8.368716879e-3f) * r2 + Pack(1.666652063e-1f);
    const Pack power = (odd * r + even) * r2 + r + Pack(1.0f);
    const detail::PackBits whole = (detail::PackBits)shifted.v << 23;  // what 12582912 adds is shifted out
    return Pack((Pack::Vector)((detail::PackBits)power.v + whole));
}

/// ln x within 2 units in the last place (relative error 2e-7) for normal positive x; of any other x, some finite
/// number.
inline Pack log(const Pack& x) {
    // x = 2^k m, sqrt(1/2) <= m < sqrt(2)
    const detail::PackBits bits = (detail::PackBits)x.v, from_half = bits - 0x3f3504f3u;
    const Pack k(__builtin_convertvector((detail::PackInts)from_half >> 23, Pack::Vector));
    const Pack f = Pack((Pack::Vector)(bits - (from_half & ~0x7fffffu))) - Pack(1.0f);
    // the minimax polynomial of (ln(1 + f) - f + f^2 / 2) / f^3: relative error of ln(1 + f) 5.8e-9
    const Pack f2 = f * f, f4 = f2 * f2;
    const Pack low = (Pack(3.333333171e-1f) + f * Pack(-2.500082103e-1f)) +
                     f2 * (Pack(2.000122688e-1f) + f * Pack(-1.662335739e-1f));
    const Pack high = (Pack(1.420175797e-1f) + f * Pack(-1.316018192e-1f)) +
                      f2 * (Pack(1.276157712e-1f) + f * Pack(-7.634497869e-2f));
    const Pack tail = f2 * (f * (high * f4 + low) - Pack(0.5f)) - k * Pack(2.12194440e-4f);
    return (tail + f) + k * Pack(0.693359375f);
}

}  // namespace radiafit

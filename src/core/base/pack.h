#pragma once
#include <cstdint>
#include <type_traits>

#include "base/lane_math.h"
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

/// Eight numbers as two vectors of four: one of 64 bytes would, without AVX-512, be compared and selected number by
/// number and never be kept in registers. With it, fits took as long by both (AMD EPYC, family 25).
template <class Half, int instructions>
struct Halves {
    Half low, high;
    auto operator[](int lane) const { return lane < 4 ? low[lane] : high[lane - 4]; }

    using Truths = Halves<decltype(Half{} < Half{}), instructions>;
    friend Halves operator+(const Halves& a, const Halves& b) { return {a.low + b.low, a.high + b.high}; }
    friend Halves operator-(const Halves& a, const Halves& b) { return {a.low - b.low, a.high - b.high}; }
    friend Halves operator*(const Halves& a, const Halves& b) { return {a.low * b.low, a.high * b.high}; }
    friend Halves operator/(const Halves& a, const Halves& b) { return {a.low / b.low, a.high / b.high}; }
    friend Halves operator&(const Halves& a, const Halves& b) { return {a.low & b.low, a.high & b.high}; }
    friend Halves operator|(const Halves& a, const Halves& b) { return {a.low | b.low, a.high | b.high}; }
    friend Halves operator-(const Halves& a) { return {-a.low, -a.high}; }
    friend auto operator<(const Halves& a, const Halves& b) { return Truths{a.low < b.low, a.high < b.high}; }
    friend auto operator<=(const Halves& a, const Halves& b) { return Truths{a.low <= b.low, a.high <= b.high}; }
    friend auto operator!=(const Halves& a, const Halves& b) { return Truths{a.low != b.low, a.high != b.high}; }
};
}  // namespace detail

/// Eight numbers that go through arithmetic side by side: `real` of the shared texts where eight problems are lanes.
/// Which instructions a program is compiled for is part of the type, since it decides how one is passed. Comparisons
/// give a mask; max, min and select treat NaN as std::max, std::min and ?: do.
template <class real, int instructions = detail::instructions>
struct PackOf {
    static constexpr int size = 8;
    static constexpr bool halved = std::is_same_v<real, double>;
    using Vector = std::conditional_t<halved, detail::Halves<Lanes<real>, instructions>, PairLanes<real>>;
    /// Eight truths.
    struct Mask {
        decltype(Vector{} < Vector{}) bits;
        bool operator[](int lane) const { return bits[lane] != 0; }
        void set(int lane, bool x) { put(bits, lane, x ? -1 : 0); }
        friend Mask operator&(const Mask& a, const Mask& b) { return {a.bits & b.bits}; }
        friend Mask operator|(const Mask& a, const Mask& b) { return {a.bits | b.bits}; }
    };
    Vector v;

    PackOf() = default;                            ///< holds nothing yet; PackOf{} is zero
    PackOf(real x) : v{x, x, x, x, x, x, x, x} {}  // the braces of two vectors may be left out
    template <class Other>
    requires(std::is_arithmetic_v<Other> && !std::is_same_v<Other, real>) explicit PackOf(Other x) : PackOf(real(x)) {}
    explicit PackOf(const Vector& x) : v(x) {}
    explicit PackOf(const PairLanes<real>& x) requires(halved) : v{lower<real>(x), upper<real>(x)} {}
    /// As one vector.
    [[gnu::always_inline]] PairLanes<real> joined() const {
        if constexpr (halved)
            return join<real>(v.low, v.high);
        else
            return v;
    }

    real operator[](int lane) const { return v[lane]; }
    void set(int lane, real x) { put(v, lane, x); }

    friend PackOf operator+(const PackOf& a, const PackOf& b) { return PackOf(a.v + b.v); }
    friend PackOf operator-(const PackOf& a, const PackOf& b) { return PackOf(a.v - b.v); }
    friend PackOf operator*(const PackOf& a, const PackOf& b) { return PackOf(a.v * b.v); }
    friend PackOf operator/(const PackOf& a, const PackOf& b) { return PackOf(a.v / b.v); }
    friend PackOf operator-(const PackOf& a) { return PackOf(-a.v); }
    PackOf& operator+=(const PackOf& b) { return v = v + b.v, *this; }
    PackOf& operator-=(const PackOf& b) { return v = v - b.v, *this; }
    PackOf& operator*=(const PackOf& b) { return v = v * b.v, *this; }

    friend Mask operator<(const PackOf& a, const PackOf& b) { return {a.v < b.v}; }
    friend Mask operator<=(const PackOf& a, const PackOf& b) { return {a.v <= b.v}; }
    friend Mask operator>(const PackOf& a, const PackOf& b) { return {b.v < a.v}; }
    friend Mask operator>=(const PackOf& a, const PackOf& b) { return {b.v <= a.v}; }
    friend PackOf max(const PackOf& a, const PackOf& b) { return select(a < b, b, a); }
    friend PackOf min(const PackOf& a, const PackOf& b) { return select(b < a, b, a); }
    static PackOf select(const Mask& c, const PackOf& a, const PackOf& b) {
        if constexpr (halved)
            return PackOf(Vector{c.bits.low ? a.v.low : b.v.low, c.bits.high ? a.v.high : b.v.high});
        else
            return PackOf(c.bits ? a.v : b.v);
    }
    friend PackOf sqrt(PackOf x) {
        for (int lane = 0; lane < size; ++lane) x.set(lane, std::sqrt(x[lane]));
        return x;
    }
    friend PackOf log(PackOf x) requires(halved) {
        for (int lane = 0; lane < size; ++lane) x.set(lane, std::log(x[lane]));
        return x;
    }
    friend void set_lane(PackOf& to, int lane, real x) { to.set(lane, x); }
    /// Lane by lane a where `condition` is not zero, b elsewhere.
    friend PackOf select_nonzero(const PackOf& condition, const PackOf& a, const PackOf& b) {
        return select({condition.v != Vector{}}, a, b);
    }

private:
    template <class Eight, class Number>
    static void put(Eight& to, int lane, Number x) {
        if constexpr (halved)
            (lane < 4 ? to.low : to.high)[lane % 4] = x;
        else
            to[lane] = x;
    }
};

using Pack = PackOf<float>;
using WidePack = PackOf<double>;

inline WidePack widen(const Pack& x) {
    return WidePack({__builtin_convertvector(lower<float>(x.v), Lanes<double>),
                     __builtin_convertvector(upper<float>(x.v), Lanes<double>)});
}
inline Pack narrow(const WidePack& x) {
    const Lanes<float> low = __builtin_convertvector(x.v.low, Lanes<float>);
    const Lanes<float> high = __builtin_convertvector(x.v.high, Lanes<float>);
    return Pack(__builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7));
}

/// base/lane_math.h.
inline Pack exp(const Pack& x) {
    Pack y;
    lane_math::exp_of_floats(x.v, y.v);
    return y;
}
inline Pack log(const Pack& x) {
    Pack y;
    lane_math::log_of_floats(x.v, y.v);
    return y;
}

}  // namespace radiafit

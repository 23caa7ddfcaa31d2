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

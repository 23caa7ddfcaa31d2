#pragma once
#include <cmath>

/// Four lanes of a scalar in one register: three colour channels and a lane of padding that every kernel keeps at zero.
/// Programs may be compiled for other instructions than the library: these functions are never calls, whose registers
/// could differ.
namespace radiafit {

namespace detail {
template <class real>
struct LanesOf;
template <>
struct LanesOf<float> {
    using type = float __attribute__((vector_size(16)));
    using pair = float __attribute__((vector_size(32)));
};
template <>
struct LanesOf<double> {
    using type = double __attribute__((vector_size(32)));
    using pair = double __attribute__((vector_size(64)));
};
}  // namespace detail

template <class real>
using Lanes = typename detail::LanesOf<real>::type;

/// Two of them side by side.
template <class real>
using PairLanes = typename detail::LanesOf<real>::pair;

template <class real>
[[gnu::always_inline]] inline PairLanes<real> join(const Lanes<real>& a, const Lanes<real>& b) {
    return __builtin_shufflevector(a, b, 0, 1, 2, 3, 4, 5, 6, 7);
}
template <class real>
[[gnu::always_inline]] inline Lanes<real> lower(const PairLanes<real>& x) {
    return __builtin_shufflevector(x, x, 0, 1, 2, 3);
}
template <class real>
[[gnu::always_inline]] inline Lanes<real> upper(const PairLanes<real>& x) {
    return __builtin_shufflevector(x, x, 4, 5, 6, 7);
}
template <class real>
[[gnu::always_inline]] inline Lanes<real> fold(const PairLanes<real>& x) {
    return lower<real>(x) + upper<real>(x);
}

template <class real>
[[gnu::always_inline]] inline Lanes<real> broadcast3(real x) {
    return Lanes<real>{x, x, x, real(0)};
}

[[gnu::always_inline]] inline float select_nonzero(float condition, float a, float b) { return condition != 0 ? a : b; }
[[gnu::always_inline]] inline double select_nonzero(double condition, double a, double b) {
    return condition != 0 ? a : b;
}
[[gnu::always_inline]] inline void set_lane(Lanes<float>& to, int lane, float x) { to[lane] = x; }
[[gnu::always_inline]] inline void set_lane(Lanes<double>& to, int lane, double x) { to[lane] = x; }
/// Lane by lane a where `condition` is not zero, b elsewhere.
[[gnu::always_inline]] inline Lanes<float> select_nonzero(const Lanes<float>& condition, const Lanes<float>& a,
                                                          const Lanes<float>& b) {
    return condition != 0 ? a : b;
}
[[gnu::always_inline]] inline Lanes<double> select_nonzero(const Lanes<double>& condition, const Lanes<double>& a,
                                                           const Lanes<double>& b) {
    return condition != 0 ? a : b;
}

/// Lane by lane, NaN as std::max has it.
[[gnu::always_inline]] inline Lanes<float> max(const Lanes<float>& a, const Lanes<float>& b) { return a < b ? b : a; }
[[gnu::always_inline]] inline Lanes<double> max(const Lanes<double>& a, const Lanes<double>& b) {
    return a < b ? b : a;
}
[[gnu::always_inline]] inline Lanes<float> sqrt(const Lanes<float>& x) {
    return Lanes<float>{std::sqrt(x[0]), std::sqrt(x[1]), std::sqrt(x[2]), std::sqrt(x[3])};
}
[[gnu::always_inline]] inline Lanes<double> sqrt(const Lanes<double>& x) {
    return Lanes<double>{std::sqrt(x[0]), std::sqrt(x[1]), std::sqrt(x[2]), std::sqrt(x[3])};
}

template <class real>
[[gnu::always_inline]] inline Lanes<double> widen(const Lanes<real>& x) {
    return Lanes<double>{double(x[0]), double(x[1]), double(x[2]), double(x[3])};
}

}  // namespace radiafit

#pragma once

/// Four lanes of a scalar in one register: three colour channels and a lane of padding that every kernel keeps at zero.
namespace radiafit {

namespace detail {
template <class real>
struct LanesOf;
template <>
struct LanesOf<float> {
    using type = float __attribute__((vector_size(16)));
};
template <>
struct LanesOf<double> {
    using type = double __attribute__((vector_size(32)));
};
}  // namespace detail

template <class real>
using Lanes = typename detail::LanesOf<real>::type;

template <class real>
inline Lanes<real> broadcast3(real x) {
    return Lanes<real>{x, x, x, real(0)};
}

template <class real>
inline Lanes<double> widen(const Lanes<real>& x) {
    return Lanes<double>{double(x[0]), double(x[1]), double(x[2]), double(x[3])};
}

}  // namespace radiafit

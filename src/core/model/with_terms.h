#pragma once
#include <type_traits>

namespace radiafit {

/// Calls body(integral_constant K) with K = terms where that is 1, 2 or 3, else K = 0: a count known at run time only.
/// Returns what it returns.
template <class Body>
auto with_terms(int terms, const Body& body) {
    switch (terms) {
        case 1:
            return body(std::integral_constant<int, 1>{});
        case 2:
            return body(std::integral_constant<int, 2>{});
        case 3:
            return body(std::integral_constant<int, 3>{});
        default:
            return body(std::integral_constant<int, 0>{});
    }
}

}  // namespace radiafit

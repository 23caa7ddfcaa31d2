#pragma once

namespace radiafit {

/// a where c is true, else b, of any number: plain ones compare to a bool, others to a mask of their own.
template <class number, class Condition>
[[gnu::always_inline]] inline number select_number(const Condition& c, const number& a, const number& b) {
    if constexpr (__is_same(Condition, bool))
        return c ? a : b;
    else
        return number::select(c, a, b);
}

}  // namespace radiafit

#pragma once
#include "model/prelude.h"

namespace radiafit::view_text {

/// shaders/model/view_basis.glsl for any scalar type.
template <class real_type>
struct ViewPolynomials {
    using real = real_type;
    using real3 = shared_text::real3_t<real>;
    static real max(const real& a, const real& b) { return std::max(a, b); }
#include "model/view_basis.glsl"
    static constexpr int degree = VIEW_DEGREE, term_count = VIEW_TERMS;
#undef VIEW_DEGREE
#undef VIEW_TERMS
};

}  // namespace radiafit::view_text

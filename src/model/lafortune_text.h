#pragma once
#include "model/prelude.h"

/// shaders/model/lafortune.glsl as C++: Eq. 16-17 for any scalar type.
namespace radiafit {
namespace shared_text {
using std::exp, std::log, std::max;

template <class real_type>
struct Lafortune {
    using real = real_type;
    using real2 = real2_t<real>;
    using real3 = real3_t<real>;
#include "model/lafortune.glsl"
    static constexpr int term_count = TERM_COUNT, basis_count = BASIS_COUNT, shape_count = SHAPE_COUNT;
#undef TERM_COUNT
#undef BASIS_COUNT
#undef SHAPE_COUNT
};
}  // namespace shared_text

template <class real>
using LafortuneText = shared_text::Lafortune<real>;

}  // namespace radiafit

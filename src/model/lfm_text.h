#pragma once
#include "model/prelude.h"

/// shaders/model/lfm.glsl as C++: Eq. 14-15 for any scalar type.
namespace radiafit {

using std::floor, std::max, std::min, std::sqrt;

/// Real3 lets a SIMD pack stand for the three channels; it needs +, -, * component by component.
template <class real_type, class real3_type = shared_text::real3_t<real_type>>
struct LfmText {
    using real = real_type;
    using real2 = shared_text::real2_t<real>;
    using real3 = real3_type;
    using real4 = shared_text::real4_t<real>;
#include "model/lfm.glsl"
};

}  // namespace radiafit

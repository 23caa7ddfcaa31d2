#pragma once
#include "model/prelude.h"

/// shaders/model/lfm.glsl as C++: Eq. 14-15 for any scalar type.
namespace radiafit {
namespace shared_text {
using std::floor, std::max, std::min, std::sqrt;

template <class real_type, class real3_type>
struct Lfm {
    using real = real_type;
    using real2 = real2_t<real>;
    using real3 = real3_type;
    using real4 = real4_t<real>;
#include "model/lfm.glsl"
};
}  // namespace shared_text

/// real3 may be a SIMD pack that holds the three channels; part 2 of the text needs no more than + and *.
template <class real, class real3 = shared_text::real3_t<real>>
using LfmText = shared_text::Lfm<real, real3>;

}  // namespace radiafit

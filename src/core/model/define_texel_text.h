// Once for each texel-local model, so without a guard: with RADIAFIT_TEXEL_MODEL its name and RADIAFIT_TEXEL_FILE its
// text, defines texel_text::NAME<real>, the text for any scalar type (docs/texel-models.md).
#include "model/texel_text_begin.h"

namespace radiafit::texel_text {

template <class real_type>
struct RADIAFIT_TEXEL_MODEL {
    using real = real_type;
    template <class other>
    using with = RADIAFIT_TEXEL_MODEL<other>;
    using real2 = shared_text::real2_t<real>;
    using real3 = shared_text::real3_t<real>;
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-parameter"  // a model need not look at all that it is given
#pragma GCC diagnostic ignored "-Wpsabi"             // its types say for which instructions they are (base/pack.h)
#include RADIAFIT_TEXEL_FILE
#pragma GCC diagnostic pop
#if !defined(TERM_COUNT) || !defined(BASIS_COUNT) || !defined(SHAPE_COUNT)
#error "a texel model's text defines TERM_COUNT, BASIS_COUNT and SHAPE_COUNT; see docs/texel-models.md"
#endif
    static constexpr const char* name = RADIAFIT_TEXEL_STRING(RADIAFIT_TEXEL_MODEL);
#ifndef SHAPED_COUNT
#define SHAPED_COUNT 1
#endif
    static constexpr int term_count = TERM_COUNT, basis_count = BASIS_COUNT, shape_count = SHAPE_COUNT;
    static constexpr int shaped_count = SHAPED_COUNT;
#undef SHAPED_COUNT
#undef TERM_COUNT
#undef BASIS_COUNT
#undef SHAPE_COUNT
};

}  // namespace radiafit::texel_text

#undef RADIAFIT_TEXEL_MODEL
#undef RADIAFIT_TEXEL_FILE

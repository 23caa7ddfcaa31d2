#pragma once
#include "cpu/texel_batches.h"
#include "cpu/texel_fit.h"
#include "model/texel_texts.h"

/// Fits of the texel-local models that there are.
namespace radiafit {

#define EACH(NAME)                                              \
    extern template class TexelFit<texel_text::NAME<Pack>>;     \
    extern template class TexelBatches<texel_text::NAME<Pack>>; \
    extern template class LaneEngine<TexelBatches<texel_text::NAME<Pack>>>;
RADIAFIT_TEXEL_MODELS(EACH)
#undef EACH

}  // namespace radiafit

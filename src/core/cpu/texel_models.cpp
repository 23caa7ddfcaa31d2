#include "cpu/texel_models.h"

#include "cpu/lane_engine_impl.h"
#include "cpu/texel_batches_impl.h"
#include "cpu/texel_fit_impl.h"

namespace radiafit {

#define EACH(NAME)                                       \
    template class TexelFit<texel_text::NAME<Pack>>;     \
    template class TexelBatches<texel_text::NAME<Pack>>; \
    template class LaneEngine<TexelBatches<texel_text::NAME<Pack>>>;
RADIAFIT_TEXEL_MODELS(EACH)
#undef EACH

}  // namespace radiafit

// The texel-local models that there are: one line each.
#include "cpu/texel_fit_impl.h"
#include "model/lafortune_text.h"

namespace radiafit {

template class TexelFit<LafortuneText<Pack>>;

}  // namespace radiafit

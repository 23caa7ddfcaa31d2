#include "cpu/texel_models.h"

#include "cpu/texel_fit_impl.h"

namespace radiafit {

template class TexelFit<LafortuneText<Pack>>;

}  // namespace radiafit

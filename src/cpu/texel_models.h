#pragma once
#include "cpu/texel_fit.h"
#include "model/lafortune_text.h"

/// The texel-local models that there are.
namespace radiafit {

using LafortuneFit = TexelFit<LafortuneText<Pack>>;
extern template class TexelFit<LafortuneText<Pack>>;

}  // namespace radiafit

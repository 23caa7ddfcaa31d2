#pragma once
#include <memory>

#include "reference/ceres_texel.h"

namespace radiafit::fits {

/// ceres::TinySolver on the texels of a model: CeresTexelOptions' methods `tiny` and `tiny_pack`.
template <class Text>
std::unique_ptr<CeresTexels<Text>> tiny_texels(const CeresTexelOptions& options);

}  // namespace radiafit::fits

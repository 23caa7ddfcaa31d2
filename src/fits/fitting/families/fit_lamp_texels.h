#pragma once
#include "fitting/solvers/solve.h"
#include "lightbasis/light_basis_fit.h"

namespace radiafit::fits {

/// A light basis, learned from and solved for the texels of any atlas: what of a fit neither dataset nor request says
/// is filled. learning_s, if given: seconds.
LightBasisFit fit_lamp_texels(const Dataset& dataset, const Atlas& atlas, const std::vector<uint32_t>& views,
                              const SharedTexels& samples, const FitRequest& request, FitRun* run = nullptr,
                              double* learning_s = nullptr);

}  // namespace radiafit::fits

#pragma once
#include <Eigen/Core>
#include <vector>

#include "lightbasis/light_basis.h"

namespace radiafit::fits {

/// A texel's values under lamps.
struct LampValues {
    const std::vector<LampAndHalf>* directions;
    const Eigen::MatrixXf* values;  ///< [lamps][3]
};

struct ChosenKernel : LightKernel<double> {
    double smoothing = 0.01;
};

/// Of lengths and smoothings in steps the ones by which a Gaussian process predicts values best that were left out one
/// by one (Rasmussen and Williams 2006, section 5.4.2), over these texels. with_half: also of the half vectors, which
/// are made use of where that predicts clearly better than the lamps alone.
ChosenKernel choose_kernel(const std::vector<LampValues>& texels, bool with_half);

}  // namespace radiafit::fits

#pragma once
#include <Eigen/Core>
#include <vector>

#include "base/linear.h"
#include "base/rings.h"

namespace radiafit::fits {

/// A texel's values under lamps.
struct LampValues {
    const std::vector<Vec3f>* directions;
    const Eigen::MatrixXf* values;  ///< [lamps][3]
};

struct ChosenKernel {
    double length = 0.5, smoothing = 0.01;
};

/// Of lengths and smoothings in steps the ones by which a Gaussian process predicts values best that were left out one
/// by one (Rasmussen and Williams 2006, section 5.4.2), over these texels.
ChosenKernel choose_kernel(const std::vector<LampValues>& texels);

}  // namespace radiafit::fits

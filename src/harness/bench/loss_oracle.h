#pragma once
#include <algorithm>
#include <cmath>

#include "base/rings.h"
#include "model/loss.h"

/// The losses written down naively in double, with no code in common with shaders/model/loss.glsl.
namespace radiafit::harness {

struct LossOracle {
    double value = 0;   ///< of 1/2 r^2, as the loss has it
    double weight = 1;  ///< d value / d (1/2 r^2)
    /// By how much a residual that is off by a share of `size` throws the weight off, as a multiple of that share.
    double sensitivity = 0;

    LossOracle(const Loss& loss, double r, double size) {
        const double delta = double(loss.scale), absolute = std::abs(r);
        value = r * r / 2;
        if (loss.kind == LossKind::huber && absolute > delta) {
            value = delta * (absolute - delta / 2);
            weight = delta / absolute;
        } else if (loss.kind == LossKind::cauchy) {
            value = delta * delta / 2 * std::log1p(r * r / (delta * delta));
            weight = 1 / (1 + r * r / (delta * delta));
        }
        if (loss.robust()) sensitivity = 2 * size / std::max(absolute, delta);
    }
};

}  // namespace radiafit::harness

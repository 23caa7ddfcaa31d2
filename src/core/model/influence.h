#pragma once
#include "model/loss.h"

namespace radiafit {

/// What a residual r of n numbers, s = |r|^2, counts for: psi(r) = w(s) r, and the trace of its derivative, n w + 2 s
/// w' (Huber, Robust Statistics, 1981).
struct Influence {
    double weight, slope;
};
inline Influence influence_of(const Loss& loss, double s, int n) {
    return with_loss(loss, [&](const auto& of) {
        constexpr double step = 1e-4;
        const double weight = of.weight(s);
        return Influence{weight, n * weight + (of.weight(s * (1 + step)) - of.weight(s * (1 - step))) / step};
    });
}

}  // namespace radiafit

#pragma once
#include <span>

#include "model/coefficient_solver.h"

namespace radiafit {

/// Coefficients of one shape by least squares within the bounds of `Model`, a TexelLocal, from sums over samples in
/// order: for each basis function its products with those up to it, then with the three channels' targets. out:
/// [basis][3]. Returns what they add to the error, from coefficients 0 on: 0 or less where bounds allow 0.
template <class Model>
double coefficients_of_sums(std::span<const float> sums, std::span<float> out) {
    constexpr int basis = Model::basis;
    constexpr double noise = 1e-6;  // smaller pivots, as a part of their diagonal entry, are rounding of floats' sums
    SmallMatrix<double, basis> normal{};
    SmallVector<double, basis> slope[3];
    const float* at = sums.data();
    for (size_t k = 0; k < size_t(basis); ++k) {
        for (size_t j = 0; j <= k; ++j) normal[k][j] = double(*at++);
        for (auto& channel : slope) channel[k] = -double(*at++);
    }
    const bool bounded =
        Model::bounded(3 * basis - 3) && Model::bounded(3 * basis - 2) && Model::bounded(3 * basis - 1);
    // a plain linear fit has no bounds that would keep coefficients small where samples don't determine each of them
    const CoefficientSolver<Model, double> solver(normal, bounded ? noise : 10 * noise,
                                                  bounded ? SmallPivots::raised : SmallPivots::left_out);
    double change = 0;
    for (size_t c = 0; c < 3; ++c) {
        const auto best = solver.from_zero(c, slope[c]);
        for (size_t k = 0; k < size_t(basis); ++k) out[3 * k + c] = float(best.coefficients[k]);
        change += best.change;
    }
    return change;
}

}  // namespace radiafit

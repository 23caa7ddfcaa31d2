#pragma once
#include <span>

#include "model/small_solve.h"
#include "model/texel_local.h"

namespace radiafit {

/// Coefficients of one shape by least squares within their bounds, from sums over samples in order: for each basis
/// function its products with those up to it, then with the three channels' targets. out: [basis][3]. Returns what they
/// take from the error, from coefficients 0 on: 0 or less.
template <int basis>
double coefficients_of_sums(std::span<const float> sums, const double (&bounds)[basis][2], std::span<float> out) {
    constexpr double noise = 1e-6;  // smaller pivots, as a part of their diagonal entry, are rounding of floats' sums
    SmallMatrix<double, basis> normal{};
    SmallVector<double, basis> slope[3];
    const float* at = sums.data();
    for (size_t k = 0; k < size_t(basis); ++k) {
        for (size_t j = 0; j <= k; ++j) normal[k][j] = double(*at++);
        for (auto& channel : slope) channel[k] = -double(*at++);
    }
    const bool bounded = are_meant({bounds[basis - 1][0], bounds[basis - 1][1]});
    // a plain linear fit has no bounds that would keep coefficients small where samples don't determine each of them
    const SmallFactor<double, basis> factor(normal, bounded ? noise : 10 * noise,
                                            bounded ? SmallPivots::raised : SmallPivots::left_out);
    double change = 0;
    for (size_t c = 0; c < 3; ++c) {
        const auto best = bounded_step<double, basis>(normal, factor, slope[c], {}, bounds);
        for (size_t k = 0; k < size_t(basis); ++k) out[3 * k + c] = float(best.step[k]);
        change += best.change;
    }
    return change;
}

}  // namespace radiafit

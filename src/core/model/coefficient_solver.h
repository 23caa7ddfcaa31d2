#pragma once
#include <array>
#include <optional>

#include "model/small_solve.h"
#include "model/texel_local.h"

namespace radiafit {

/// The coefficients of each channel by linear least squares within their bounds: those of `Model`, a TexelLocal.
template <class Model, class real>
class CoefficientSolver {
public:
    static constexpr int B = Model::basis;
    using Vector = SmallVector<real, B>;

    /// a: what the channels share of the normal equations, its lower triangle. floor and small: of SmallFactor.
    CoefficientSolver(const SmallMatrix<real, B>& a, double floor, SmallPivots small)
        : a_(a), factors_{SmallFactor<real, B>(of_channel(0), floor, small)} {
        if constexpr (Model::any_held()) {
            factors_[1].emplace(of_channel(1), floor, small);
            factors_[2].emplace(of_channel(2), floor, small);
        }
    }

    /// From coefficients x within their bounds, where the error's slope is g.
    BoundedStep<real, B> step(size_t c, const Vector& x, const Vector& g) const {
        return bounded_step<real, B>(a_, *factors_[Model::any_held() ? c : 0], g, x, Model::channel_bounds(c));
    }

    struct Solution {
        Vector coefficients;
        real change;  ///< of the error, from coefficients 0 on
    };
    /// at_zero: the error's slope where all coefficients are 0, which needn't be within their bounds.
    Solution from_zero(size_t c, const Vector& at_zero) const {
        Vector x{}, g = at_zero;
        real change(0.0);
        if constexpr (!Model::coefficients_may_be_zero()) {
            for (size_t k = 0; k < size_t(B); ++k) {
                x[k] = real(Model::least(k, c));
                for (size_t j = 0; j < size_t(B); ++j) g[j] += a_[j < k ? k : j][j < k ? j : k] * x[k];
            }
            for (size_t k = 0; k < size_t(B); ++k) change += real(0.5) * x[k] * (at_zero[k] + g[k]);
        }
        const auto best = step(c, x, g);
        if constexpr (Model::coefficients_may_be_zero()) return {best.step, best.change};
        for (size_t k = 0; k < size_t(B); ++k) x[k] += best.step[k];
        return {x, change + best.change};
    }

private:
    /// Without what the coefficients that are held have in common with others.
    SmallMatrix<real, B> of_channel(size_t c) const {
        SmallMatrix<real, B> a = a_;
        if constexpr (Model::any_held())
            for (size_t k = 0; k < size_t(B); ++k)
                for (size_t j = 0; j < k; ++j)
                    if (Model::held(int(3 * k + c)) || Model::held(int(3 * j + c))) a[k][j] = real(0.0);
        return a;
    }

    SmallMatrix<real, B> a_;
    std::array<std::optional<SmallFactor<real, B>>, 3> factors_;  ///< of each channel; the first's for all if alike
};

}  // namespace radiafit

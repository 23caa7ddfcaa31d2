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
        : a_(a), floor_(floor), factors_{SmallFactor<real, B>(of_channel(0), floor, small)} {
        if constexpr (Model::any_held()) {
            factors_[1].emplace(of_channel(1), floor, small);
            factors_[2].emplace(of_channel(2), floor, small);
        }
    }

    /// From coefficients x within their bounds, where the error's slope is g.
    BoundedStep<real, B> step(size_t c, const Vector& x, const Vector& g) const {
        auto out = bounded_step<real, B>(a_, *factors_[Model::any_held() ? c : 0], g, x, Model::channel_bounds(c));
        if constexpr (Model::shaped > 1)  // which may overlap, so that who belongs at a bound is not known beforehand
            for (int round = 0; round < 2 * B; ++round) follow_free(c, x, g, out);
        return out;
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
    /// Towards the optimum of those that aren't pushed against a bound, until the first meets one: a round of the
    /// active-set method (Nocedal and Wright, Numerical Optimization, 2006, section 16.5).
    void follow_free(size_t c, const Vector& x, const Vector& g, BoundedStep<real, B>& so_far) const {
        const auto& bounds = Model::channel_bounds(c);
        SmallMatrix<real, B> a = a_;
        Vector slope, down;
        using Mask = decltype(real(0.0) < real(0.0));
        Mask free[size_t(B)];
        for (size_t k = 0; k < size_t(B); ++k) {
            slope[k] = g[k];
            for (size_t j = 0; j < size_t(B); ++j) slope[k] += a_[j < k ? k : j][j < k ? j : k] * so_far.step[j];
            const real at = x[k] + so_far.step[k];
            free[k] = ((at > real(beside(bounds[k][0], 1))) | (slope[k] < real(0.0))) &
                      ((at < real(beside(bounds[k][1], -1))) | (slope[k] > real(0.0)));
            down[k] = select_number<real>(free[k], -slope[k], real(0.0));
            for (size_t j = 0; j < k; ++j) {
                const Mask both = free[k] & free[j];
                a[k][j] = select_number<real>(both, a[k][j], real(0.0));
            }
        }
        using std::max, std::min;
        Vector by = SmallFactor<real, B>(a, floor_).solve(down);
        real share(1.0);
        for (size_t k = 0; k < size_t(B); ++k) {
            const real at = x[k] + so_far.step[k],
                       ahead = select_number<real>(by[k] < real(0.0), at - real(bounds[k][0]), real(bounds[k][1]) - at);
            const real length = max(by[k], -by[k]);
            share =
                select_number<real>(length * share > ahead, max(ahead, real(0.0)) / max(length, real(1e-300)), share);
        }
        real change(0.0);
        for (size_t k = 0; k < size_t(B); ++k) {
            real bend(0.0);
            for (size_t j = 0; j < size_t(B); ++j) bend += a_[j < k ? k : j][j < k ? j : k] * by[j];
            change += share * by[k] * (slope[k] + real(0.5) * share * bend);
        }
        const auto falls = change < real(0.0);
        for (size_t k = 0; k < size_t(B); ++k) {
            const real step = so_far.step[k] + select_number<real>(falls, share * by[k], real(0.0));
            so_far.step[k] = min(max(step, real(bounds[k][0]) - x[k]), real(bounds[k][1]) - x[k]);
        }
        so_far.change += select_number<real>(falls, change, real(0.0));
    }
    /// A bound, but for rounding.
    static constexpr double beside(double bound, int side) {
        return bound + side * 1e-13 * (1 + (bound < 0 ? -bound : bound));
    }
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
    double floor_;
    std::array<std::optional<SmallFactor<real, B>>, 3> factors_;  ///< of each channel; the first's for all if alike
};

}  // namespace radiafit

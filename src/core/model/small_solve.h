#pragma once
#include <array>
#include <cstddef>

#include "model/prelude.h"

/// Linear systems of a few unknowns for any scalar: doubles, or packs of them. Branch-free.
namespace radiafit {

template <class real, int N>
using SmallVector = std::array<real, size_t(N)>;
template <class real, int N>
using SmallMatrix = std::array<SmallVector<real, N>, size_t(N)>;

/// What becomes of a pivot that is too small: `raised`, so that a larger matrix is factored where A is not positive
/// definite; or the unknown is `left_out`: solutions have 0 there.
enum class SmallPivots { raised, left_out };

/// A = L D L' of a symmetric matrix; of A its lower triangle is read. Pivots below `floor` times their diagonal entry
/// are small.
template <class real, int N>
class SmallFactor {
public:
    SmallFactor(const SmallMatrix<real, N>& a, double floor, SmallPivots small = SmallPivots::raised) : l_(a) {
        using std::max, std::min;
        for (size_t j = 0; j < size_t(N); ++j) {
            real pivot = a[j][j];
            for (size_t k = 0; k < j; ++k) pivot -= l_[j][k] * l_[j][k] * pivot_[k];
            smallest_ = min(smallest_, pivot / (a[j][j] + real(1e-30)));
            pivot_[j] = max(pivot, real(floor) * a[j][j] + real(1e-30));
            inverse_[j] = real(1.0) / pivot_[j];
            if (small == SmallPivots::left_out)
                inverse_[j] = select_number<real>(pivot <= real(floor) * a[j][j], real(0.0), inverse_[j]);
            for (size_t i = j + 1; i < size_t(N); ++i) {
                real x = a[i][j];
                for (size_t k = 0; k < j; ++k) x -= l_[i][k] * l_[j][k] * pivot_[k];
                l_[i][j] = x * inverse_[j];
            }
        }
    }

    SmallVector<real, N> solve(const SmallVector<real, N>& right) const {
        SmallVector<real, N> b = forward(right);
        for (size_t i = size_t(N); i-- > 0;) {
            b[i] = b[i] * inverse_[i];
            for (size_t k = i + 1; k < size_t(N); ++k) b[i] -= l_[k][i] * b[k];
        }
        return b;
    }
    /// L^-1 b
    SmallVector<real, N> forward(const SmallVector<real, N>& right) const {
        SmallVector<real, N> b = right;
        for (size_t i = 0; i < size_t(N); ++i)
            for (size_t k = 0; k < i; ++k) b[i] -= l_[i][k] * b[k];
        return b;
    }
    /// x' A^-1 y of x = forward(..), y = forward(..)
    real product(const SmallVector<real, N>& x, const SmallVector<real, N>& y) const {
        real sum(0.0);
        for (size_t k = 0; k < size_t(N); ++k) sum += x[k] * y[k] * inverse_[k];
        return sum;
    }
    /// The smallest pivot relative to its diagonal entry, before it was raised: 1 where columns are orthogonal, about 0
    /// or less where one depends on others or is zero.
    const real& smallest() const { return smallest_; }

private:
    SmallMatrix<real, N> l_;
    SmallVector<real, N> pivot_, inverse_;
    real smallest_{1.0};
};

/// The step from x that minimizes g' step + 1/2 step' A step within bounds [N][lowest, highest], and what the step adds
/// to that (never more than 0). x is within bounds.
template <class real, int N>
struct BoundedStep {
    SmallVector<real, N> step;
    real change{0.0};
};
template <class real, int N>
BoundedStep<real, N> bounded_step(const SmallMatrix<real, N>& a, const SmallFactor<real, N>& factor,
                                  const SmallVector<real, N>& g, const SmallVector<real, N>& x,
                                  const double (&bounds)[N][2]) {
    using std::max, std::min;
    const auto within = [&](size_t i, const real& step) {
        return min(max(step, real(bounds[i][0]) - x[i]), real(bounds[i][1]) - x[i]);
    };
    const auto slope = [&](size_t i, const SmallVector<real, N>& step) {
        real sum = g[i];
        for (size_t k = 0; k < size_t(N); ++k) sum += a[i < k ? k : i][i < k ? i : k] * step[k];
        return sum;
    };
    BoundedStep<real, N> out{factor.solve(g)};
    bool bounded = false;
    SmallVector<real, N> inverse_diagonal;
    for (size_t i = 0; i < size_t(N); ++i) {
        inverse_diagonal[i] = real(1.0) / (a[i][i] + real(1e-30));
        out.step[i] = within(i, -out.step[i]);
        bounded = bounded || bounds[i][1] - bounds[i][0] < 1e30;
    }
    // From the corner that clamping may have led to, one unknown after another: exact after one round where the clamped
    // ones are those that belong at their bounds.
    for (int round = 0; bounded && round < 4; ++round)
        for (size_t i = 0; i < size_t(N); ++i)
            out.step[i] = within(i, out.step[i] - slope(i, out.step) * inverse_diagonal[i]);
    for (size_t i = 0; i < size_t(N); ++i) out.change += real(0.5) * out.step[i] * (g[i] + slope(i, out.step));
    const auto falls = out.change < real(0.0);
    for (size_t i = 0; i < size_t(N); ++i) out.step[i] = select_number<real>(falls, out.step[i], real(0.0));
    out.change = select_number<real>(falls, out.change, real(0.0));
    return out;
}

}  // namespace radiafit

#pragma once
#include <optional>
#include <vector>

#include "reference/half_step.h"
#include "reference/schur_lanes.h"

namespace radiafit::fits {

/// F(h) = min over surface maps g of E_t(g, h), with gradient and Hessian in the view map h, for a vertex's three
/// channels side by side:
///     grad F = dE/dh,   Hess F = E_hh - E_gh' E_gg^-1 E_gh   at g(h)  (E_hg has the residuals: the exact Hessian)
/// Golub and Pereyra 1973; surface maps don't couple with one another, so E_gg is one banded block per map.
class ProjectedEnergy {
public:
    using V = Lanes<double>;
    ProjectedEnergy(const LfmVertex& vertex, const TileSmoothness& tiles, const Smoothness& view);

    /// p's surface maps become the best for its view map. False where they can't be solved for.
    bool evaluate(V* p);
    /// Of the last evaluate(): F, and the derivatives of F without E_b of h, in LfmVertex's order of the view map.
    V error() const { return error_; }
    V gradient(size_t i) const { return gradient_[i]; }
    V hessian(size_t i, size_t j) const {  ///< j <= i
        V out = i - j <= own_.band() ? own_.at(i, j) : V{};
        if (column_[i] < touched_ && column_[j] < touched_)
            out -= __builtin_convertvector(eliminated_->at(column_[i], column_[j]), V);
        return out;
    }
    V diagonal(size_t i) const { return own_.at(i, i); }  ///< of E_hh

private:
    template <int K>
    V add_samples(size_t map, const V* p);

    const LfmVertex& vertex_;
    const Smoothness& view_;
    SurfaceStep solve_surface_;
    std::vector<size_t> first_group_;  ///< [maps + 1]
    std::vector<size_t> column_;       ///< [view parameters] among those that samples reach; touched_ for the others
    size_t touched_ = 0;
    V error_{};
    std::vector<V> gradient_;               ///< [view parameters] dE/dh but for E_b
    LaneCholesky own_;                      ///< E_hh
    std::optional<SchurLanes> eliminated_;  ///< E_gh' E_gg^-1 E_gh among columns that samples reach
};

}  // namespace radiafit::fits

#pragma once
#include <vector>

#include "reference/lfm_vertex.h"

namespace radiafit::fits {

/// E_t of one channel of a vertex and its gradient, by one pass over samples: what line search methods want.
/// x [texels][term] in LfmVertex's order.
class ChannelEnergy {
public:
    ChannelEnergy(const LfmVertex& vertex, int channel);

    size_t size() const { return vertex_->size(); }
    /// gradient [size()], or null.
    double evaluate(const double* x, double* gradient) const;
    /// diag(J'J)/S-bar + 20 lambda, floored at 1e-4 of its largest entry: the preconditioner of cg-modern.
    std::vector<double> diagonal(const double* x) const;

private:
    template <int K>
    double data(const double* x, double* gradient) const;
    double penalties(const double* x, double* gradient) const;
    double smoothness(const MapNeighbours& map, double lambda, const double* x, double* gradient) const;

    const LfmVertex* vertex_;
    int channel_;
    std::vector<double> target_;           ///< [S]
    mutable std::vector<double> scratch_;  ///< gradient, then L x of one map
};

}  // namespace radiafit::fits

#pragma once
#include "base/lanes.h"
#include "model/lfm.h"
#include "model/penalty.h"

namespace radiafit {

/// Sums along d of one vertex, a lane per channel; see LineSums in shaders/optimize/problem_state.glsl.
struct LineLanes {
    Lanes<double> gauss_newton{}, curvature{}, third{}, fourth{};
};

/// What follows the loop over a vertex's samples: the normalization to E/S-bar, and the penalties (Eq. 11).
/// Blocks are a vertex's part of LfmLayout's order, four lanes at a time: `maps` surface maps, then the view map.
template <class real>
class LfmObjective {
public:
    using V = Lanes<real>;
    LfmObjective(const LfmOptions& options, int tile_texels);

    /// Constants of one vertex.
    struct Scale {
        real inverse_density = 1;  ///< 1 / S-bar: ring texels / samples
        V lambda_view{};
    };
    /// mean [3] of the targets L t.
    Scale scale(size_t ring_texels, uint32_t samples, const float* mean) const;

    /// From sums over samples (E, gradient, and diag(J'J) if not null) to E_t, its gradient and the preconditioner
    /// diag(J'J)/S-bar + 20 lambda, floored at 1e-4 of its largest entry per channel.
    void finish_direction(const Scale& scale, size_t maps, const V* x, V* gradient, V* diagonal,
                          Lanes<double>& error) const;
    /// The same for the sums along d.
    void finish_line(const Scale& scale, size_t maps, const V* x, const V* d, LineLanes& sums) const;

private:
    void precondition(const Scale& scale, size_t maps, V* diagonal) const;

    LfmOptions options_;
    size_t tile_size_, view_size_;  ///< lanes of a map, all terms
    MapNeighbours tile_neighbours_, view_neighbours_;
};

extern template class LfmObjective<float>;
extern template class LfmObjective<double>;

}  // namespace radiafit

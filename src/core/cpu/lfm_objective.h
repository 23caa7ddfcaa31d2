#pragma once
#include <span>

#include "base/lanes.h"
#include "cpu/lane_engine.h"
#include "model/lfm.h"
#include "model/penalty.h"

namespace radiafit {

/// Sums along d of one vertex, a lane per channel.
using LineLanes = LineSumsOf<Lanes<double>>;

/// A vector in LfmLayout's order, four lanes at a time, from plain numbers and back.
template <class real>
void set_lanes(std::span<const float> values, Lanes<real>* lanes) {
    for (size_t i = 0; i < values.size() / 4; ++i)
        for (int c = 0; c < 4; ++c) lanes[i][c] = values[4 * i + size_t(c)];
}
template <class real>
void get_lanes(const Lanes<real>* lanes, std::span<float> values) {
    for (size_t i = 0; i < values.size() / 4; ++i)
        for (int c = 0; c < 4; ++c) values[4 * i + size_t(c)] = float(lanes[i][c]);
}

/// What follows the loop over a vertex's samples: the normalization to E/S-bar, and the penalties (Eq. 11).
/// Blocks are a vertex's part of LfmLayout's order, four lanes at a time: `maps` surface maps, then the view map.
template <class real>
class LfmObjective {
public:
    using V = Lanes<real>;
    explicit LfmObjective(const LfmOptions& options);

    /// Constants of one vertex.
    struct Scale {
        real inverse_density = 1;  ///< 1 / S-bar: ring texels / samples
        V lambda_view{};
    };
    /// mean [3] of the targets L t.
    Scale scale(size_t ring_texels, uint32_t samples, const float* mean) const;

    /// Terms outside [first, last) stay as they are: their gradient is zero from now on.
    void fit_terms(int first, int last) { first_term_ = first, last_term_ = last; }

    /// From sums over samples (E, gradient, and diag(J'J) if not null) to E_t, its gradient and the preconditioner
    /// diag(J'J)/S-bar + 20 lambda, floored at 1e-4 of its largest entry per channel. sides: of the surface maps.
    void finish_direction(const Scale& scale, std::span<const uint8_t> sides, const V* x, V* gradient, V* diagonal,
                          Lanes<double>& error) const;
    /// The same for the sums along d.
    void finish_line(const Scale& scale, std::span<const uint8_t> sides, const V* x, const V* d, LineLanes& sums) const;

private:
    void precondition(const Scale& scale, size_t view_base, V* diagonal) const;
    size_t surface_size(std::span<const uint8_t> sides) const;

    LfmOptions options_;
    size_t view_size_;  ///< lanes of the view map, all terms
    MapNeighbours view_neighbours_;
    int first_term_ = 0, last_term_ = 1 << 30;
};

extern template class LfmObjective<float>;
extern template class LfmObjective<double>;

}  // namespace radiafit

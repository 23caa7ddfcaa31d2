#pragma once
#include <array>
#include <cstring>
#include <vector>

#include "base/lanes.h"
#include "geometry/atlas.h"
#include "geometry/vertex_rings.h"
#include "optim/engine.h"
#include "samples/sample_list.h"

/// The samples of a list as the problems of the vertices around their triangles see them.
namespace radiafit {

namespace detail {
using OneSample = uint16_t __attribute__((vector_size(8)));
using OneWidened = int32_t __attribute__((vector_size(16)));
using TwoSamples = uint16_t __attribute__((vector_size(16)));
using TwoWidened = int32_t __attribute__((vector_size(32)));
}  // namespace detail

/// The channels of a sample and, in the fourth lane, its texel, which a weight of zero there removes.
template <class real>
Lanes<real> load_sample(const Sample* s) {
    detail::OneSample one;
    static_assert(sizeof one == sizeof *s);
    std::memcpy(&one, s, sizeof one);
    // in two steps, each of which is one instruction
    return __builtin_convertvector(__builtin_convertvector(one, detail::OneWidened), Lanes<real>);
}
/// load_sample() of s[0] and s[1].
template <class real>
PairLanes<real> load_two_samples(const Sample* s) {
    detail::TwoSamples two;
    static_assert(sizeof two == 2 * sizeof *s);
    std::memcpy(&two, s, sizeof two);
    return __builtin_convertvector(__builtin_convertvector(two, detail::TwoWidened), PairLanes<real>);
}

/// What turns a sample into the target L t of one of its triangle's corners: Lambda at the texel's centre times the
/// list's scale.
template <class real>
class TargetWeights {
public:
    TargetWeights(const TriangleAtlas& atlas, float scale);
    /// [texels] of a tile of that side.
    const Lanes<real>* of(const Corner& corner, int side) const { return weights_[size_t(side)][corner.corner].data(); }
    /// Side of the corner's tile.
    int side(const Corner& corner) const { return sides_[corner.triangle]; }

private:
    std::array<std::array<std::vector<Lanes<real>>, 3>, largest_side + 1>
        weights_;                 ///< of sides that no map has: empty
    std::vector<uint8_t> sides_;  ///< [triangles]
};

/// Samples and mean target of each vertex.
template <class real>
ProblemStatistics count_rings(const VertexRings& rings, const SampleList& samples, const TargetWeights<real>& weights);

extern template class TargetWeights<float>;
extern template class TargetWeights<double>;

}  // namespace radiafit

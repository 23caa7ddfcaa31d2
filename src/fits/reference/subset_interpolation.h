#pragma once
#include <span>
#include <vector>

#include "reference/triangulation.h"

namespace radiafit::fits {

/// Interpolation at fixed places among many subsets of some points: what Triangulation(subset).at(place) says, for
/// less. A triangle of all points whose corners are in the subset is one of the subset's triangles, since its
/// circumcircle holds no point. Where a corner is missing, the subset's triangles have their corners among the
/// neighbours of the missing points, as if these had been deleted one after another; so it suffices to triangulate
/// those neighbours.
class SubsetInterpolation {
public:
    /// At least one point, all finite; std::invalid_argument otherwise.
    SubsetInterpolation(std::vector<Vec2d> points, std::vector<Vec2d> places);

    /// The weights at each place; their points are positions in the subset. subset: ascending, not empty.
    std::vector<Triangulation::Weights> of(std::span<const uint32_t> subset) const;

private:
    std::vector<Triangulation::Weights> by_itself(std::span<const uint32_t> subset) const;

    std::vector<Vec2d> points_, places_;
    Triangulation all_;
    bool every_point_is_a_corner_;              ///< else neighbours are not known, and every subset stands by itself
    std::vector<Triangulation::Weights> base_;  ///< of all points, at each place
};

}  // namespace radiafit::fits

#pragma once
#include <vector>

#include "geometry/atlas.h"
#include "viewbasis/view_basis.h"

namespace radiafit::fits {

/// Texels that a basis is learned from, drawn evenly from the usable ones by a seed: some from the whole surface, and
/// some from each of its blocks. The same whatever is seen of them.
struct BasisTexels {
    struct Place {
        uint32_t tile, local;
    };
    std::vector<Place> everywhere;
    // As ViewBasis has them.
    Vec3f origin = Vec3f::Zero();
    float cube = 0;
    std::vector<std::array<int32_t, 3>> cubes;
    std::vector<std::vector<Place>> of_block;  ///< [cubes]; empty where one basis is for all

    std::vector<bool> mask(const TriangleAtlas& atlas) const;  ///< [texel_count()] of all of them
};

inline constexpr size_t texels_per_block = 200;

/// At most `everywhere` from the whole surface, and from each of about `blocks` blocks at most texels_per_block.
BasisTexels draw_basis_texels(const TriangleAtlas& atlas, size_t everywhere, int blocks);

}  // namespace radiafit::fits

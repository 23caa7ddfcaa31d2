#pragma once
#include <vector>

#include "basis/basis_blocks.h"
#include "dataset/dataset.h"

namespace radiafit::fits {

/// Texels that a basis is learned from, drawn evenly from the usable ones by a seed: some from the whole surface, and
/// some from each of its blocks. The same whatever is seen of them.
struct BasisTexels {
    std::vector<uint32_t> everywhere;
    BasisBlocks blocks;                           ///< without numbers
    std::vector<std::vector<uint32_t>> of_block;  ///< [cubes]; empty where one basis is for all

    std::vector<bool> mask(const Atlas& atlas) const;  ///< [texel_count()] of all of them
};

/// Where a surface begins in each of the three directions, and its area.
struct SurfaceExtent {
    Vec3f origin = Vec3f::Zero();
    double area = 0;
};
SurfaceExtent extent_of(const Mesh& mesh);
SurfaceExtent extent_of(const Grid& grid);

/// At most `everywhere` from the whole surface, and from each of about `blocks` blocks at most `per_block`.
BasisTexels draw_basis_texels(const Atlas& atlas, const SurfaceExtent& extent, size_t everywhere, int blocks,
                              size_t per_block);

}  // namespace radiafit::fits

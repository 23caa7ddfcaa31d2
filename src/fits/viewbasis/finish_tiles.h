#pragma once
#include <algorithm>

#include "base/journal.h"
#include "base/rings.h"
#include "geometry/atlas.h"

namespace radiafit::fits {

/// finish_blocks() over an atlas' triangles that have texels: solve(tile, worker), and fields(visit, first texel, how
/// many), which hands what was solved of so many texels to `visit`.
template <class Fields, class Solve>
void finish_tiles(Journal* journal, const TriangleAtlas& atlas, const Fields& fields, const Solve& solve) {
    constexpr size_t block_tiles = 64;
    const size_t tiles = atlas.tile_count();
    const auto end_of = [&](size_t block) { return std::min((block + 1) * block_tiles, tiles); };
    finish_blocks(
        journal, (tiles + block_tiles - 1) / block_tiles,
        [&](auto& visit, size_t block) {
            const size_t begin = block * block_tiles, per_tile = atlas.texels_per_tile();
            fields(visit, begin * per_tile, (end_of(block) - begin) * per_tile);
        },
        [&](size_t block, int worker) {
            for (size_t tile = block * block_tiles; tile < end_of(block); ++tile)
                if (!atlas.degenerate(uint32_t(tile))) solve(uint32_t(tile), worker);
        });
}

}  // namespace radiafit::fits

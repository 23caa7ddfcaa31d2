#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "compute/buffer_engine.h"
#include "geometry/atlas.h"
#include "geometry/vertex_rings.h"
#include "model/lfm.h"

namespace radiafit {

/// The whole numbers that lead passes over light field maps from vertices and tiles to their maps, samples and
/// neighbours: shaders/compute/tables.glsl says what each table holds. All lie in one buffer on the device.
class MapTables {
public:
    /// As shaders/compute/tables.glsl numbers them.
    enum Table {
        vertices,
        maps,
        sites,
        neighbours,
        cell_first,
        cell_pairs,
        pair_first,
        pair_groups,
        tiles,
        blocks,
        texels,
        table_count
    };
    /// Words of a vertex and of a tile, as shaders/compute/vertices.glsl and tiles.glsl have them.
    enum VertexWord { surface, view, ring, ring_end, pair, pair_end, site, vertex_words };
    enum TileWord {
        vertex,         ///< of three corners
        map = 3,        ///< of three corners
        group = 6,      ///< first of the tile's groups of samples
        group_number,   ///< how many
        texel,          ///< first in `texels`
        texel_number,   ///< how many; 0 of a degenerate triangle
        target_weight,  ///< first in the targets' weights
        group_block,    ///< in `blocks`
        texel_block,
        tile_words
    };

    /// Fills what the maps alone say; samples' words are 0. target_scale: of a sample's channel. Nothing of the
    /// arguments is kept. Throws UserError for a ring that is too long.
    MapTables(const TriangleAtlas& atlas, const VertexRings& rings, const LfmLayout& layout, float target_scale);

    std::vector<uint32_t>& operator[](Table which) { return table_[which]; }
    uint32_t& of_vertex(size_t v, VertexWord word) { return table_[vertices][v * vertex_words + word]; }
    uint32_t& of_tile(size_t t, int word) { return table_[tiles][t * tile_words + size_t(word)]; }
    size_t tile_count() const { return size_t(tile_count_); }

    /// Once, when all tables are filled; the host lets go of them. Throws UserError where the device fetches from none
    /// so large.
    void upload();
    /// Binds and sets all buffers and uniforms of these that a program uses.
    void bind_to(const Program& program) const;

private:
    int vertex_count_, tile_count_, view_neighbours_ = 0;
    std::array<std::vector<uint32_t>, table_count> table_;
    std::array<int, table_count> begin_{};
    std::vector<float> weights_;
    FetchedBuffer on_device_, target_weights_;
};

}  // namespace radiafit

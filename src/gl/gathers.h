#pragma once
#include <vector>

#include "gl/map_vector.h"
#include "gl/pass_runner.h"
#include "gl/tile_places.h"

namespace radiafit {

/// What a gather does with its entries.
enum class Gather { sum, squares, maximum };

/// The gathers of Section 5.2.1, at most 16 look-ups a pass: texels of a tile to one value per (triangle, corner) in
/// levels (2 for n <= 20); corners of a ring to one value per vertex, any valence; and texels of a view map likewise.
class Gathers {
public:
    explicit Gathers(const MapShape& shape);

    /// The tile sums of one corner of `source` (a 3-layer array in the SLS layout), for the tiles that the mesh draws.
    /// mark_tiles() must be called whenever it draws others than before.
    void mark_tiles(const SlsMesh& mesh) { marks_.update(mesh); }
    const Texture& tile_sums() const { return tile_levels_.back().sums; }
    void tiles(PassRunner& run, const Texture& source, int corner, Gather gather);
    /// Ring sums of `source`, one value per tile and corner such as tile_sums(), into `target` (M texels).
    void rings(PassRunner& run, const Texture& source, const Framebuffer& target, Gather gather, bool blend,
               TileOrder order = TileOrder::layout);
    /// Sums over view maps (`source`: one layer) into `target` (M texels), blended.
    void views(PassRunner& run, const Texture& source, const Framebuffer& target, Gather gather);

private:
    struct TileLevel {
        int source_side, side;
        Texture sums;  ///< 3 layers
        std::vector<Framebuffer> targets;
        Program programs[3];
    };
    struct RingLevel {
        Texture table;
        Texture nodes;  ///< absent in the last level
        Framebuffer target;
    };
    struct ViewLevel {
        Texture sums;  ///< absent in the last level
        Framebuffer target;
        Program programs[3];
    };
    void make_tile_levels(const MapShape& shape);
    void make_ring_levels(const MapShape& shape, TileOrder order);
    void make_view_levels(const MapShape& shape);

    std::vector<TileLevel> tile_levels_;
    std::vector<RingLevel> ring_levels_[2];  ///< by TileOrder
    std::vector<ViewLevel> view_levels_;
    Program ring_programs_[3];
    TileMarks marks_;
};

}  // namespace radiafit

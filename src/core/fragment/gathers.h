#pragma once
#include <vector>

#include "fragment/map_vector.h"
#include "fragment/pass_runner.h"
#include "fragment/tile_places.h"

namespace radiafit {

/// What a gather does with its entries.
enum class Gather { sum, squares, maximum };

/// The gathers of Section 5.2.1, at most 16 look-ups a pass: texels of a tile to one value per (triangle, corner) in
/// levels (2 for n <= 20, or n <= 14 where an entry takes two look-ups); corners of a ring, of any valence, to one
/// value per vertex; and texels of a view map to one value per vertex.
class Gathers {
public:
    /// Look-ups for entries in one pass. Of the 16, gathers over tiles take one for the tile; rings three for places.
    static constexpr int tile_entries = 15, product_entries = 7, ring_entries = 12;
    /// Levels of a gather inside tiles but the last, which has one: bands that each leaves of a tile.
    static std::vector<int> tile_bands(int texels, int entries);

    /// constant_loops: every fragment looks up as many entries, those that it doesn't have being left out of the sum.
    Gathers(const MapShape& shape, Storage storage, bool constant_loops);

    /// Which tiles count; to be called whenever the mesh draws others than before.
    void mark_tiles(const SlsMesh& mesh) { marks_.update(mesh); }
    const TileMarks& marks() const { return marks_; }
    /// The sums of tiles, [3 corners] in the order of TilePlaces.
    const Texture& tile_sums() const { return tile_sums_; }
    /// One corner of tile_sums() from `source`, a 3-layer array in the SLS layout.
    void tiles(PassRunner& run, const Texture& source, int corner, Gather gather);
    /// The same from the products of residuals and one term of surface maps, two look-ups each. squares: from the
    /// squares of the map's texels instead, where the alpha of `residuals` says that there is a sample.
    void tile_products(PassRunner& run, const Texture& residuals, const Texture& surface, int corner, int term,
                       bool squares);
    /// Ring sums of `source`, one value per tile and corner such as tile_sums(), into `target` (M texels).
    void rings(PassRunner& run, const Texture& source, const Framebuffer& target, Gather gather, bool blend);
    /// Sums over view maps (`source`: one layer) into `target` (M texels), blended.
    void views(PassRunner& run, const Texture& source, const Framebuffer& target, Gather gather);

private:
    struct Bands {
        Texture sums;
        Framebuffer target;
    };
    /// One way to gather texels of tiles: levels until one band is left, which goes to tile_sums_.
    struct TileGather {
        std::vector<Bands> levels;                    ///< all but the last
        Program first[3];                             ///< by Gather, or by `squares`
        std::vector<std::array<Program, 2>> further;  ///< [level][maximum]
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
    TileGather make_tile_gather(const MapShape& shape, int entries, const std::vector<Defines>& variants);
    void gather_tiles(PassRunner& run, TileGather& gather, const Program& first, int corner, bool maximum);
    void make_ring_levels(const MapShape& shape);
    void make_view_levels(const MapShape& shape);

    bool constant_loops_;
    TileMarks marks_;
    Texture tile_sums_;
    std::vector<Framebuffer> tile_targets_;  ///< [corner]
    TileGather tile_gather_, product_gather_;
    std::vector<RingLevel> ring_levels_;
    std::vector<ViewLevel> view_levels_;
    Program ring_programs_[3];
};

}  // namespace radiafit

#pragma once
#include <cstdint>
#include <vector>

#include "geometry/atlas.h"
#include "gl/texture.h"

namespace radiafit {

class SlsMesh;

/// The order of tiles in textures with one texel per tile.
enum class TileOrder {
    layout,  ///< as the atlas with tiles of side 1
    facing   ///< neighbours in the texture face alike, so that fragments of tiles seen and unseen seldom share a vector
};

/// Where the texel of each tile stands in such a texture: y * columns + x.
struct TilePlaces {
    int columns, rows;
    std::vector<uint32_t> of_tile;
    TilePlaces(const TriangleAtlas& atlas, TileOrder order);
};

/// One texel per tile, 1 for those that the mesh draws. Two textures take turns, so that an upload doesn't wait for
/// passes that still read the last one.
class TileMarks {
public:
    explicit TileMarks(TilePlaces places);
    /// Whenever the mesh draws others than before.
    void update(const SlsMesh& mesh);
    void bind(unsigned unit) const { marks_[turn_].bind(unit); }
    const TilePlaces& places() const { return places_; }

private:
    TilePlaces places_;
    std::vector<uint8_t> texels_;
    Texture marks_[2];
    int turn_ = 0;
};

}  // namespace radiafit

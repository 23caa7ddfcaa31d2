#pragma once
#include <cstdint>
#include <vector>

#include "geometry/atlas.h"
#include "gl/texture.h"

namespace radiafit {

class SlsMesh;

/// Where each tile is in textures with one texel per tile: y * columns + x. Neighbours in the texture face alike,
/// so that fragments of tiles seen and unseen seldom share a vector.
struct TilePlaces {
    int columns, rows;
    std::vector<uint32_t> of_tile;
    explicit TilePlaces(const TriangleAtlas& atlas);
};

/// One texel per tile, R32UI: 1 + the tile for those that the mesh draws, else 0. Two textures take turns, so that an
/// upload doesn't wait for passes that still read the last one.
class TileMarks {
public:
    explicit TileMarks(TilePlaces places);
    /// To be called whenever the mesh draws other tiles than before.
    void update(const SlsMesh& mesh);
    const Texture& texture() const { return marks_[turn_]; }
    const TilePlaces& places() const { return places_; }

private:
    TilePlaces places_;
    std::vector<uint32_t> texels_;
    Texture marks_[2];
    int turn_ = 0;
};

}  // namespace radiafit

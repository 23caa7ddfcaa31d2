#pragma once
#include <array>
#include <string>

#include "exchange/padded_tiles.h"
#include "exchange/surface_normals.h"

namespace radiafit::tools {

/// Heights over a grid's plane.
struct Relief {
    TextureImage heights;  ///< up out of the plane, unit of `step`; a second channel is 0 where no surface is, else 1
    float least = 0, most = 0;   ///< of them
    std::array<double, 2> step;  ///< from a texel to the next in its row and its column: world units, or pixels (1, 1)
    int parts = 0;               ///< connected pieces, each of mean 0

    bool in_pixels() const { return step[0] == 1 && step[1] == 1; }
};

/// By integrate_normals() over the texels that are usable. The atlas is the grid's.
Relief relief_of(const SurfaceNormals& normals, const Atlas& atlas, const Grid& grid);

/// As a PNG file's bytes, grey of 16 bits: 1 is the least height, 65535 the greatest, 0 none.
std::string height_png(const Relief& relief);

}  // namespace radiafit::tools

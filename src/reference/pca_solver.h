#pragma once
#include <vector>

#include "geometry/atlas.h"
#include "geometry/vertex_rings.h"
#include "model/lfm.h"
#include "reference/tile_views.h"

namespace radiafit {

struct PcaFit {
    std::vector<float> parameters;  ///< LfmLayout's order
    // Entries of the factorized matrices [ring surface texels x view texels that a look-up can reach], over all
    // vertices; one entry is three values.
    uint64_t entries = 0;
    uint64_t outside_hull = 0;   ///< of these, view texels outside the hull of the directions a texel is seen from
    uint64_t unseen_texels = 0;  ///< of these, of surface texels that no image sees
    double invented_share() const { return entries ? double(outside_hull + unseen_texels) / double(entries) : 0; }
};

/// Light field mapping by matrix factorization, as in Chen et al. 2002 ("Light Field Mapping"). For every vertex and
/// channel the ring's light field is resampled to a dense matrix of surface texels times view texels and factorized
/// by a truncated, uncentred singular value decomposition, joint over the ring, so that its triangles share view maps.
///   - Directions: the images that see a surface texel lie scattered in the vertex's view map; their Delaunay
///     triangulation is interpolated linearly at the view texels' centres. Texels of a triangle that the same images
///     see share it.
///   - View texels outside the hull take the value at the hull's nearest point.
///   - Surface texels that no image sees take the mean of their neighbours in the tile, ring by ring; a tile that no
///     image sees the mean over the seen texels of the vertex's ring. A vertex with none keeps zeros.
///   - Targets are weighted by L, as in Eq. 14.
PcaFit pca_solver(const Dataset& dataset, const TriangleAtlas& atlas, const VertexRings& rings, const LfmLayout& layout,
                  const TileViews& tiles);

/// Which of m x m view texels have a weight in some look-up: those whose bilinear support meets the view map's disc.
std::vector<uint32_t> reachable_view_texels(int view_side);

}  // namespace radiafit

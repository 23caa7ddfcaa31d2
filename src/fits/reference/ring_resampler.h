#pragma once
#include <Eigen/Core>
#include <map>
#include <vector>

#include "dataset/dataset.h"
#include "geometry/atlas.h"
#include "geometry/vertex_rings.h"
#include "model/penalty.h"
#include "reference/resampling_counts.h"
#include "reference/subset_interpolation.h"
#include "reference/tile_views.h"
#include "reference/truncated_svd.h"

namespace radiafit::fits {

/// One vertex's light field, dense. Rows: surface texels [ring position][tile texel]; columns:
/// RingResampler::view_texels().
struct DenseLightField {
    Eigen::MatrixXd channel[3];  ///< L t (Eq. 14)
    Unmeasured invented;         ///< where an entry was made up
    ResamplingCounts counts;
    std::vector<uint8_t> seen;  ///< [rows] by some image
};

/// Resamples what images see of a vertex's ring to a dense matrix of surface texels times view texels, as factorization
/// needs it (Chen et al. 2002).
///   - Directions: the images that see a surface texel lie scattered in the vertex's view map; their Delaunay
///     triangulation is interpolated linearly at the view texels' centres. Texels of the ring that the same images see
///     share it.
///   - View texels outside the hull take the value at the hull's nearest point.
///   - Surface texels that no image sees take the mean of their neighbours in the tile, ring by ring; a tile that no
///     image sees the mean over the seen texels of the vertex's ring.
class RingResampler {
public:
    /// All must outlive the resampler but the dataset.
    RingResampler(const Dataset& dataset, const TriangleAtlas& atlas, const VertexRings& rings, const TileViews& tiles,
                  int view_side);

    /// Which of the m x m view texels are columns: those that a look-up can reach.
    const std::vector<uint32_t>& view_texels() const { return view_texels_; }
    /// Overwrites `out`, reusing its storage. False: no image sees any of the ring, and all is zero.
    bool resample(size_t vertex, DenseLightField& out) const;

private:
    /// Positions in the tiles' views of the images that see a texel, in ascending order.
    using ImageSet = std::vector<uint32_t>;
    /// For every column, which of a set's images to mix.
    using Mixing = std::vector<Triangulation::Weights>;
    /// Of a tile's images, as they lie in the vertex's view map.
    SubsetInterpolation interpolation(size_t vertex, uint32_t tile) const;
    void interpolate_tile(size_t vertex, uint32_t tile, size_t first_row, std::map<ImageSet, Mixing>& mixings,
                          DenseLightField& out) const;
    /// first_rows: of the ring's tiles, and where the last one ends.
    void fill_unseen(std::span<const Corner> ring, std::span<const size_t> first_rows, DenseLightField& out) const;
    void grow_tile(const MapNeighbours& neighbours, size_t first_row, uint8_t* known, DenseLightField& out) const;

    const TriangleAtlas* atlas_;
    const VertexRings* rings_;
    const TileViews* tiles_;
    std::vector<Frame> frames_;
    std::vector<uint32_t> view_texels_;
    std::vector<Vec2d> view_centers_;
    std::vector<Vec3d> cameras_;
};

/// Which of m x m view texels have a weight in some look-up: those whose bilinear support meets the view map's disc.
std::vector<uint32_t> reachable_view_texels(int view_side);

}  // namespace radiafit::fits

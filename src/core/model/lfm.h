#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/linear.h"
#include "geometry/atlas.h"
#include "geometry/mesh.h"
#include "geometry/vertex_rings.h"
#include "model/loss.h"

namespace radiafit {

inline constexpr const char* lfm_name = "lfm";  ///< of the model in requests and in fit.json

enum class ViewLookup { bilinear, nearest };
enum class Mode { paper, modern };

constexpr int max_terms = 16;  ///< of a light field map

/// Corrections of the paper's objective (docs/paper.md, M4 to M6). All are on, unless an experiment measures what one
/// is worth.
struct LfmCorrections {
    bool penalty_curvature = true;   ///< the penalties' second derivatives are part of d'Hd
    bool normalized = true;          ///< E over S-bar
    bool scaled_lambda_view = true;  ///< lambda_view times what its gradients grow by
};

/// What a light field map fit is made of (Section 4.1), and the weights of its objective (Eq. 11).
struct LfmOptions {
    int terms = 1;         ///< K in [1, max_terms]
    int surface_side = 8;  ///< n: n(n+1)/2 texels per surface map; the largest, where `sides` has one per triangle
    TileSides sides = {};
    int view_side = 8;  ///< m: m x m texels per view map, m >= 2
    ViewLookup lookup = ViewLookup::bilinear;
    Mode mode = Mode::modern;      ///< of the bounds penalty
    float lambda_surface = 1e-3f;  ///< weight of E_r on surface maps
    float lambda_view = 1e-3f;     ///< on view maps, before its scaling to the problem
    float mu = 1;                  ///< weight of E_b, first term only
    float lower = 0, upper = 16;   ///< bounds of the first term's maps
    Loss loss = {};
    LfmCorrections corrections = {};
};
/// Throws UserError unless all is within model/limits.h, and lower < upper.
void check_options(const LfmOptions& options);
/// The layout of the surface maps. The mesh must outlive it.
TriangleAtlas surface_atlas(const Mesh& mesh, const LfmOptions& options);

/// Parameters order: problem after problem, p = [p_v1 ... p_vQ] (Section 4.1). The block of vertex v holds
///     surface maps  [ring position][tile texel][term][4]     ring position as in VertexRings::ring(v)
///     view map      [view texel][term][4]
/// with channels r, g, b and one zero of padding, so that four lanes carry three channels.
class LfmLayout {
public:
    LfmLayout(const VertexRings& rings, const TriangleAtlas& atlas, int view_side, int terms);

    size_t problem_count() const { return offsets_.size() - 1; }  ///< vertices; each is three problems, one per channel
    size_t size() const { return offsets_.back(); }               ///< floats, padding included
    size_t offset(size_t v) const { return offsets_[v]; }
    size_t view_offset(size_t v) const { return offsets_[v + 1] - size_t(view_texels_) * stride(); }
    /// Where it begins in the layout of the whole mesh, where this one's is a part.
    uint64_t whole_offset(size_t v) const { return whole_offsets_ ? (*whole_offsets_)[v] : offsets_[v]; }
    size_t block_size(size_t v) const { return offsets_[v + 1] - offsets_[v]; }
    size_t stride() const { return size_t(4) * terms_; }  ///< floats per texel, all terms
    int terms() const { return terms_; }
    /// Sides of vertex v's surface maps, by ring position.
    std::span<const uint8_t> sides(size_t v) const {
        return {sides_.data() + first_maps_[v], sides_.data() + first_maps_[v + 1]};
    }
    /// Texels of all surface maps of vertex v.
    size_t surface_texels(size_t v) const { return (view_offset(v) - offsets_[v]) / stride(); }
    int view_texels() const { return view_texels_; }
    int view_side() const { return view_side_; }
    /// N as the paper counts it: scalar parameters without padding.
    uint64_t parameter_count() const { return uint64_t(size()) / 4 * 3; }
    /// Where the surface map of (triangle, corner) begins; no_map for a degenerate triangle, or a vertex without a
    /// ring.
    static constexpr size_t no_map = ~size_t(0);
    size_t map_offset(uint32_t triangle, uint32_t corner) const {
        const size_t i = 3 * size_t(triangle) + corner;
        return i < map_offsets_.size() ? map_offsets_[i] : no_map;
    }

private:
    int view_side_, view_texels_, terms_;
    std::vector<size_t> offsets_;
    std::shared_ptr<const std::vector<uint64_t>> whole_offsets_;  ///< null: of a whole mesh
    std::vector<size_t> map_offsets_;
    std::vector<uint32_t> first_maps_;  ///< [vertices + 1] into sides_
    std::vector<uint8_t> sides_;
};

/// A problem's view look-up for one image: the footprint of the bilinear (or nearest) look-up.
struct ViewFootprint {
    uint16_t texel = 0;              ///< lower-left of four; the others are +1, +m, +m+1
    float weight[4] = {0, 0, 0, 0};  ///< of (x0, y0), (x0+1, y0), (x0, y0+1), (x0+1, y0+1)
};
/// Where a camera centre (world) falls in the view map of vertex `position` with frame `frame`: in [0, 1]^2.
std::array<double, 2> view_coordinate(const Frame& frame, const Vec3f& position, const Vec3d& camera_center);
ViewFootprint view_footprint(const std::array<double, 2>& coordinate, int view_side, ViewLookup lookup);
/// Both in one.
ViewFootprint view_footprint(const Frame& frame, const Vec3f& position, const Vec3d& camera_center, int view_side,
                             ViewLookup lookup);
/// What a vertex's samples in an image from this camera weigh.
double view_weight(const Frame& frame, const Vec3f& position, const Vec3d& camera_center, SampleWeights weights);

std::string to_string(ViewLookup lookup);
std::string to_string(Mode mode);

}  // namespace radiafit

#pragma once
#include <algorithm>
#include <span>
#include <vector>

#include "base/lanes.h"
#include "base/rings.h"
#include "dataset/dataset.h"
#include "geometry/atlas.h"
#include "model/lfm.h"
#include "model/penalty.h"
#include "optim/engine.h"
#include "samples/sample_list.h"

namespace radiafit::fits {

/// One vertex's three light field mapping problems (one per channel, in lanes), in double and with copies of samples:
/// what the reference solvers read. Parameters are a vertex's part of LfmLayout's order, a texel's term per lane:
///     surface maps [ring position][tile texel][term], view map [view texel][term]
struct LfmVertex {
    using V = Lanes<double>;
    /// The samples of one (triangle, image): they share a view look-up.
    struct Group {
        uint32_t map;      ///< ring position
        uint32_t texel;    ///< lower-left of the look-up's four view texels
        double weight[4];  ///< of (x0, y0), (x0+1, y0), (x0, y0+1), (x0+1, y0+1)
        uint32_t first;    ///< into local and target; ends where the next group begins
    };
    std::vector<Group> groups;    ///< one more than there are groups: the last is a sentinel
    std::vector<uint16_t> local;  ///< [S] tile texel
    std::vector<V> target;        ///< [S] L t
    std::vector<uint8_t> sides;   ///< [maps] of the surface maps, one per triangle of the ring
    /// Where each map's texels begin [maps + 1].
    std::vector<uint32_t> first_texels = {0};
    double inverse_density = 1;  ///< 1 / S-bar
    double lambda_surface = 0;   ///< weight of E_r on surface maps
    V lambda_view{};             ///< on the view map
    LfmOptions options;          ///< terms, bounds
    const MapNeighbours* view;   ///< of the view map

    size_t sample_count() const { return local.size(); }
    size_t terms() const { return size_t(options.terms); }
    size_t maps() const { return sides.size(); }
    const MapNeighbours& tile(size_t map) const { return MapNeighbours::triangle(sides[map]); }
    size_t largest_tile() const {  ///< texels
        return sides.empty() ? 0 : TriangleTile::texels_of(*std::max_element(sides.begin(), sides.end()));
    }
    size_t surface_texels() const { return first_texels.back(); }
    size_t map_begin(size_t map) const { return first_texels[map] * terms(); }  ///< lane of a surface map's first term
    size_t view_begin() const { return surface_texels() * terms(); }            ///< lane of the view map's first term
    size_t size() const { return view_begin() + view->texel_count() * terms(); }
    /// Where each map's groups begin [maps + 1].
    std::vector<size_t> first_groups() const {
        std::vector<size_t> out;
        for (size_t i = 0; i < groups.size(); ++i)
            while (out.size() <= groups[i].map) out.push_back(i);
        return out;
    }
    /// View texel j of 4 of a look-up.
    size_t corner(const Group& g, int j) const {
        return g.texel + size_t(j & 1) + (j & 2 ? size_t(options.view_side) : 0);
    }
    /// Texels that the look-up reads: bit j for corner j. Nearest look-up reads one.
    static unsigned corners_read(const Group& g) {
        unsigned read = 0;
        for (int j = 0; j < 4; ++j)
            if (g.weight[j] != 0) read |= 1u << j;  // as one shift of a truth value, GCC 12's sanitizers read weight[?]
        return read;
    }
};

/// Gathers vertices from a sample list. All arguments but options must outlive it.
class LfmVertices {
public:
    LfmVertices(const Dataset& dataset, const TriangleAtlas& atlas, const VertexRings& rings, const SampleList& samples,
                const LfmOptions& options);

    const LfmLayout& layout() const { return layout_; }
    const ProblemStatistics& statistics() const { return statistics_; }
    /// Vertex v, which must have samples. Reuses out's storage.
    void gather(size_t v, LfmVertex& out) const;

private:
    void count();
    /// Target of a sample in a corner's map: L at its texel's centre, times its colour.
    Lanes<double> target(const Corner& corner, const Sample& sample) const;

    const Dataset* dataset_;
    const TriangleAtlas* atlas_;
    const VertexRings* rings_;
    const SampleList* samples_;
    LfmOptions options_;
    LfmLayout layout_;
    MapNeighbours view_neighbours_;
    std::vector<Frame> frames_;
    ProblemStatistics statistics_;
};

/// E_t of the three problems at p, sample by sample.
Lanes<double> lfm_error(const LfmVertex& vertex, const Lanes<double>* p);
/// lambda E_r + mu E_b alone.
Lanes<double> lfm_penalties(const LfmVertex& vertex, const Lanes<double>* p);

}  // namespace radiafit::fits

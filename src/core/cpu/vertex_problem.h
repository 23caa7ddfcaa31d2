#pragma once
#include <memory>

#include "cpu/lfm_kernels.h"
#include "geometry/atlas.h"
#include "geometry/vertex_rings.h"
#include "optim/engine.h"
#include "samples/disk_records.h"
#include "samples/sample_list.h"

namespace radiafit {

/// One vertex's problem, loaded from its record or from a list of all samples: what stays in the L2 cache while
/// LaneEngine solves it. Samples are ordered by (image, ring position, texel), targets weighted and widened once, so a
/// view look-up serves all of an image's samples. As LaneEngine's Problem it has one block, number 0.
class VertexProblem {
public:
    using Real = float;
    using V = Lanes<float>;
    using Sums = LineLanes;
    static constexpr int lanes = 3;
    /// `views`: the dataset's views that samples name by their position. All arguments but views and options must
    /// outlive the problem.
    VertexProblem(const Dataset& dataset, const TriangleAtlas& atlas, const VertexRings& rings,
                  const std::vector<uint32_t>& views, const LfmOptions& options);

    /// Takes vertex v from its block. Keeps storage.
    void load(size_t v, const DiskRecords& records, const uint8_t* block);
    /// From a list; mean [3] of the targets L t.
    void load(size_t v, const SampleList& list, const float* mean);

    // What LaneEngine asks for.
    size_t problem_count() const { return 3; }
    size_t block_count() const { return 1; }
    size_t begin(size_t block) const { return block == 0 ? 0 : size_; }
    Status first_status(size_t) const { return samples_ ? Status::active : Status::no_samples; }
    void set(std::span<const float> values, V* vector) const { set_lanes<float>(values, vector); }
    void get(const V* vector, std::span<float> values) const { get_lanes<float>(vector, values); }
    void fit_terms(int first, int last) { objective_.fit_terms(first, last); }
    size_t texels(size_t) const { return weights_.size(); }
    const LfmOptions& options() const { return options_; }
    ProblemStatistics count() const { return {{samples_}, {mean_[0], mean_[1], mean_[2]}}; }
    void direction(size_t, const V* x, V* gradient, V* fresh_p, double error[3]) const;
    void line(size_t, const V* x, const V* d, LineLanes& sums) const;

    /// The surface maps' sides; Lambda at the centre of a texel, by its place in them; and what scales the penalties.
    std::span<const uint8_t> sides() const { return sides_; }
    float lambda(size_t place) const { return weights_[place][0]; }
    const LfmObjective<float>::Scale& scale() const { return scale_; }
    /// body(footprint in the view map, weight, samples as lfm_kernels.h has them) for every image.
    template <class Body>
    void for_images(const Body& body) const {
        for (size_t g = 0; g + 1 < groups_.size(); ++g) body(groups_[g].footprint, groups_[g].weight, of_group(g));
    }

    uint64_t working_set_bytes() const;  ///< samples, look-ups and the optimizer's seven vectors

private:
    struct Group {
        uint32_t first;
        Footprint<float> footprint;
        float weight;  ///< of its samples
    };
    struct Samples {
        const V* weighted;
        const uint32_t* texels;
        size_t count;
        size_t size() const { return count; }
        uint32_t texel(size_t i) const { return texels[i]; }
        V target(size_t i) const { return weighted[i]; }
        PairLanes<float> targets(size_t i) const { return join<float>(weighted[i], weighted[i + 1]); }
    };
    Samples of_group(size_t g) const {
        const uint32_t first = groups_[g].first;
        return {targets_.data() + first, texels_.data() + first, groups_[g + 1].first - first};
    }
    void take_maps(size_t v, uint32_t samples, const float* mean);
    Group group(size_t v, uint32_t image, uint32_t first) const;
    void take_compact(const DiskRecords& records, const VertexRecord& record, const uint8_t* from);
    void take_full(const uint8_t* from);

    const TriangleAtlas* atlas_;
    const VertexRings* rings_;
    LfmOptions options_;
    LfmObjective<float> objective_;
    std::shared_ptr<const std::vector<Frame>> frames_;  ///< [vertices]; of copies, too
    std::vector<Vec3d> centers_;                        ///< of the images' cameras

    size_t size_ = 0;                         ///< of the vertex's block, in V
    std::vector<uint8_t> sides_;              ///< of its surface maps
    std::vector<const TriangleTile*> tiles_;  ///< of its surface maps
    std::vector<uint32_t> first_texels_;      ///< of its surface maps: where their texels begin
    uint32_t samples_ = 0;
    float mean_[3] = {};
    LfmObjective<float>::Scale scale_;
    std::vector<Group> groups_;  ///< one more than there are groups
    std::vector<V> targets_;
    std::vector<uint32_t> texels_;  ///< place in the vertex's surface maps
    std::vector<V> weights_;        ///< by place: Lambda at the texel's centre
};

}  // namespace radiafit

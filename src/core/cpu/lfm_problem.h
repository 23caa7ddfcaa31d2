#pragma once
#include <span>
#include <vector>

#include "cpu/lfm_kernels.h"
#include "cpu/lfm_objective.h"
#include "cpu/ring_samples.h"
#include "dataset/dataset.h"
#include "geometry/atlas.h"
#include "optim/engine.h"
#include "samples/sample_list.h"

namespace radiafit {

/// Light field mapping, one vertex at a time over a sample list: errors, gradients and curvatures of the vertex's
/// three problems (one per channel, in lanes). Samples are read by (triangle, image, texel), so view weights hoist out
/// of the inner loop and a vertex's working set stays in L2. real = double makes it the oracle of the other engines.
/// Blocks are a vertex's part of LfmLayout's order, four lanes at a time.
template <class real>
class LfmProblem {
public:
    using Real = real;
    using V = Lanes<real>;
    using Sums = LineLanes;
    static constexpr int lanes = 3;
    /// All arguments but options must outlive the problem.
    LfmProblem(const Dataset& dataset, const TriangleAtlas& atlas, const VertexRings& rings, const SampleList& samples,
               const LfmOptions& options);

    size_t vertex_count() const { return rings_->vertex_count(); }
    // What LaneEngine asks for; a block is a vertex.
    size_t problem_count() const { return 3 * vertex_count(); }
    size_t block_count() const { return vertex_count(); }
    size_t begin(size_t v) const { return layout_.offset(v) / 4; }
    Status first_status(size_t problem) const { return counts_[problem / 3] ? Status::active : Status::no_samples; }
    void set(std::span<const float> values, V* vector) const { set_lanes<real>(values, vector); }
    void get(const V* vector, std::span<float> values) const { get_lanes<real>(vector, values); }
    void fit_terms(int first, int last) { objective_.fit_terms(first, last); }

    const LfmLayout& layout() const { return layout_; }
    const LfmOptions& options() const { return options_; }
    size_t texels(size_t v) const { return layout_.surface_texels(v); }

    /// Samples and mean target per vertex; fixes S-bar and lambda_view. Call before the passes.
    ProblemStatistics count();

    /// At p (the vertex's block): E_t [3] and its gradient (the block g). fresh_p, if not null: diag(J'J)/S-bar + 20
    /// lambda, floored at 1e-4 of its largest entry per channel. A non-finite value is kept, never masked.
    void direction(size_t v, const V* p, V* g, V* fresh_p, double error[3]) const;
    /// The sums at p along d.
    void line(size_t v, const V* p, const V* d, LineLanes& sums) const;

private:
    const Footprint<real>& footprint(size_t v, uint32_t image) const {
        return footprints_[v * samples_->image_count() + image];
    }
    real weight(size_t v, uint32_t image) const {
        return weights_.empty() ? real(1) : weights_[v * samples_->image_count() + image];
    }

    const VertexRings* rings_;
    const SampleList* samples_;
    LfmOptions options_;
    LfmLayout layout_;
    LfmObjective<real> objective_;
    TargetWeights<real> target_weights_;
    std::vector<Footprint<real>> footprints_;                 ///< [vertices][images]
    std::vector<real> weights_;                               ///< [vertices][images] of samples; empty: equal
    std::vector<uint32_t> counts_;                            ///< [vertices] samples
    std::vector<typename LfmObjective<real>::Scale> scales_;  ///< [vertices]
};

extern template class LfmProblem<float>;
extern template class LfmProblem<double>;

}  // namespace radiafit

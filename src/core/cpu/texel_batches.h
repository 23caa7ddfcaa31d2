#pragma once
#include <span>
#include <vector>

#include "cpu/lane_engine.h"
#include "cpu/texel_batch.h"
#include "model/texel_local.h"
#include "model/texel_options.h"

namespace radiafit {

/// LaneEngine's Problem for a texel-local model: a block is eight texels, and a texel has one error and one step for
/// all its parameters. `Text`: a model's text with real = Pack.
///
/// E is over S-bar = samples of the texel; lambda is 0 (a Laplacian over texels would couple problems); mu E_b holds
/// every parameter to the model's bounds.
template <class Text>
class TexelBatches {
public:
    using Model = TexelLocal<Text>;
    using Batch = TexelBatch<Text::term_count>;
    using Real = float;
    using V = Pack;
    using Sums = LineSumsOf<Pack>;
    static constexpr int lanes = Pack::size;
    static constexpr size_t N = size_t(Model::parameters);

    /// batches: the samples of texels 8 i to 8 i + 7; must outlive this. texels: how many there are.
    TexelBatches(std::span<const Batch> batches, size_t texels, const TexelOptions& options)
        : batches_(batches), texels_(texels), mode_(options.mode), mu_(options.mu), loss_(options.loss) {}

    size_t problem_count() const { return texels_; }
    size_t block_count() const { return batches_.size(); }
    size_t begin(size_t block) const { return block * N; }
    float texels(size_t) const { return 1; }
    void fit_terms(int, int) {}
    Status first_status(size_t texel) const;
    /// mean: of the targets.
    ProblemStatistics count();
    void set(std::span<const float> values, Pack* vector) const;  ///< values [texels][N], TexelLocal's order
    void get(const Pack* vector, std::span<float> values) const;  ///< of parameters: not in the canonical gauge

    void direction(size_t block, const Pack* x, Pack* gradient, Pack* diagonal, double errors[lanes]) const;
    void line(size_t block, const Pack* x, const Pack* d, Sums& sums) const;

private:
    static typename Model::Parameters parameters(const Pack* x) {
        typename Model::Parameters out;
        std::copy_n(x, N, out.begin());
        return out;
    }

    std::span<const Batch> batches_;
    size_t texels_;
    Mode mode_;
    float mu_;
    Loss loss_;
    std::vector<Pack> inverse_samples_;  ///< 1 / S-bar
};

}  // namespace radiafit

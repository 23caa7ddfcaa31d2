#pragma once
#include <algorithm>
#include <vector>

#include "base/clock.h"
#include "cpu/texel_batch.h"
#include "samples/texel_loader.h"
#include "samples/texel_source.h"

namespace radiafit {

/// Reads a block of texels, and puts those of their samples that count into batches, eight texels each. One thread's.
/// `Text`: a model's text with real = Pack.
template <class Text>
class TexelBatchLoader {
public:
    using Batch = TexelBatch<Text::term_count>;
    static constexpr size_t lanes = Pack::size;
    static constexpr size_t batches_per_block = TexelSource::block / lanes;

    /// The block that begins at `begin`; how many batches there are.
    size_t load(const TexelSource& source, const TexelLoader& loader, uint32_t begin) {
        const Stopwatch clock;
        source.read(begin, block_);
        order.resize(block_.first.size() - 1);
        for (uint32_t t = 0; t < order.size(); ++t) {
            order[t] = t;
            loader.load(begin + t, block_.of(t), shaded_[t]);
        }
        std::stable_sort(order.begin(), order.end(),
                         [&](uint32_t a, uint32_t b) { return shaded_[a].size() > shaded_[b].size(); });
        for (size_t i = 0; i < order.size(); ++i) {
            Batch& batch = batches[i / lanes];
            if (i % lanes == 0) batch.clear();
            push(batch, int(i % lanes), shaded_[order[i]]);
        }
        load_s += clock.wall_s();
        return (order.size() + lanes - 1) / lanes;
    }

    static void push(Batch& batch, int lane, std::span<const ShadedSample> samples) {
        for (const ShadedSample& s : samples) {
            const auto terms = Plain::sample_terms({s.u.x(), s.u.y(), s.u.z()}, {s.v.x(), s.v.y(), s.v.z()});
            TexelSample<Text::term_count> sample;
            std::copy_n(terms.x, Text::term_count, sample.term.begin());
            std::copy_n(s.target, 3, sample.target.begin());
            sample.weight = s.weight;
            batch.push(lane, sample);
        }
    }

    std::vector<Batch> batches{batches_per_block};
    /// Texels of the block in the order in which they fill batches: by their number of samples, since the longest of
    /// eight decides what a batch costs.
    std::vector<uint32_t> order;
    double load_s = 0;  ///< wall time of load() so far

private:
    using Plain = typename Text::template with<float>;
    TexelSamples block_;
    std::vector<std::vector<ShadedSample>> shaded_{TexelSource::block};
};

}  // namespace radiafit

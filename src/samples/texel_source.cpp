#include "samples/texel_source.h"

#include <algorithm>
#include <array>
#include <memory>
#include <stdexcept>

#include "base/parallel.h"
#include "samples/texel_distribution.h"

namespace radiafit {
namespace {

/// Samples as images left them, in blocks of texels; brought into their texels' order whenever they are read.
class TexelsInMemory final : public TexelSource {
public:
    explicit TexelsInMemory(uint32_t texels) : texels_(texels), blocks_(texel_blocks(texels)) {}

    uint32_t texel_count() const override { return texels_; }
    uint64_t sample_count() const override { return samples_; }
    void read(uint32_t begin, TexelSamples& out) const override {
        const Block& from = blocks_[begin / block];
        out.first.assign(std::min(block, texels_ - begin) + 1, 0);
        from.each([&](const Entry& e) { ++out.first[e.local() + 1]; });
        for (size_t t = 1; t < out.first.size(); ++t) out.first[t] += out.first[t - 1];
        std::array<uint64_t, block> next;
        std::copy_n(out.first.begin(), out.first.size() - 1, next.begin());
        out.samples.resize(from.count);
        from.each([&](const Entry& e) {
            out.samples[next[e.local()]++] = {{e.value[0], e.value[1], e.value[2]}, e.place / block};
        });
    }

    void add(std::span<const TakenTexels> images) {
        parallel_for(blocks_.size(), 8, [&](size_t b, int) {
            for (const TakenTexels& image : images)
                for (uint32_t k = image.first[b]; k < image.first[b + 1]; ++k) {
                    const float* v = &image.values[3 * size_t(k)];
                    blocks_[b].push({{v[0], v[1], v[2]}, image.image * block + image.texels[k] % block});
                }
        });
        for (const TakenTexels& image : images) samples_ += image.count();
    }

private:
    struct Entry {
        float value[3];
        uint32_t place;  ///< image * block + texel within the block
        uint32_t local() const { return place % block; }
    };
    static_assert(sizeof(Entry) == sizeof(TexelRadiance));
    /// Grows without moving what is there.
    struct Block {
        static constexpr size_t chunk = 2048;
        std::vector<std::unique_ptr<Entry[]>> chunks;
        size_t count = 0;

        void push(const Entry& e) {
            if (count % chunk == 0) chunks.push_back(std::make_unique_for_overwrite<Entry[]>(chunk));
            chunks.back()[count++ % chunk] = e;
        }
        template <class Body>
        void each(const Body& body) const {
            for (size_t c = 0; c < chunks.size(); ++c)
                for (size_t i = 0; i < std::min(chunk, count - chunk * c); ++i) body(chunks[c][i]);
        }
    };

    uint32_t texels_;
    uint64_t samples_ = 0;
    std::vector<Block> blocks_;
};

}  // namespace

std::unique_ptr<TexelSource> gather_texels(const Dataset& dataset, const Atlas& atlas,
                                           const std::vector<uint32_t>& views, const std::vector<Distributor*>& workers,
                                           TexelDistributionStatistics& statistics) {
    if (views.size() > ~uint32_t(0) / TexelSource::block) throw std::invalid_argument("gather_texels: too many views");
    auto out = std::make_unique<TexelsInMemory>(atlas.texel_count());
    distribute_views(dataset, views, workers, statistics,
                     [&](std::span<const TakenTexels> images) { out->add(images); });
    return out;
}

}  // namespace radiafit

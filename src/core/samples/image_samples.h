#pragma once
#include <algorithm>
#include <functional>
#include <span>
#include <vector>

#include "base/parallel.h"
#include "samples/distributor.h"
#include "samples/waiting_items.h"

namespace radiafit {

/// A sample in linear light that isn't rounded to 16 bits.
struct LinearSample {
    float rgb[3];
    uint32_t place;  ///< (position of the image in the views) * (texels per block) + texel within its block
};

/// What one image leaves, in ascending texel order, so block by block of neighbours.
struct ImageBlocks {
    uint32_t covered_pixels = 0;   ///< Distribution::covered_pixels
    std::vector<uint32_t> blocks;  ///< those that take samples, ascending
    std::vector<uint32_t> first;   ///< where their samples begin, and where the last one's end
};
template <class T>
struct ImageSamples : ImageBlocks {
    std::vector<T> samples;
    /// body(block, its samples) for those of [begin, end) that have some, ascending.
    template <class Body>
    void for_blocks(size_t begin, size_t end, const Body& body) const {
        auto i = size_t(std::ranges::lower_bound(blocks, begin) - blocks.begin());
        for (; i < blocks.size() && blocks[i] < end; ++i)
            body(blocks[i], std::span(samples.data() + first[i], samples.data() + first[i + 1]));
    }
};

/// Finds the samples that images leave in the tiles of triangles.
class TileSampler {
public:
    virtual ~TileSampler() = default;
    virtual int at_once() const = 0;  ///< images that are worked on side by side
    virtual int bits() const = 0;     ///< 8: channels are multiples of 257
    virtual float scale() const = 0;  ///< of Sample::rgb, one for all images
    /// Image first + k of `views` to out[k].
    virtual void collect(std::span<const uint32_t> views, size_t first, std::span<ImageSamples<Sample>> out) = 0;
};

/// Streams images from disk, each through a distributor.
class SampleCollector final : public TileSampler {
public:
    /// `texels_per_block`: a tile's, or of as many neighbours as else belong together, 65536 at most.
    /// `workers`: one distributor per thread to use, or a single one that is then used from the calling thread only.
    /// Throws std::invalid_argument for other numbers of them.
    SampleCollector(const Dataset& dataset, uint32_t texels_per_block, std::vector<Distributor*> workers,
                    TargetSpace space);

    int at_once() const override { return int(state_.size()); }
    int bits() const override { return state_.front().stream.bits(); }
    float scale() const override { return state_.front().stream.scale16(); }
    void collect(std::span<const uint32_t> views, size_t first, std::span<ImageSamples<Sample>> out) override;
    /// The same for any atlas, whose blocks need not be tiles.
    void collect(std::span<const uint32_t> views, size_t first, std::span<ImageSamples<LinearSample>> out);

private:
    struct Worker {
        ImageStream stream;
        TargetImage image = {};
        Distribution distribution = {};
        std::vector<uint32_t> locals = {}, pixels = {};  ///< of the texels that take a pixel; room for all of the atlas
        std::vector<float> values = {};                  ///< [taken][3]
    };
    /// body(k, worker) for k in [0, count), by all workers.
    void each(size_t count, const std::function<void(size_t k, int worker)>& body);
    /// The loaded image's texels that take a pixel, by block.
    void distribute(uint32_t view, int worker, ImageBlocks& out);

    const Dataset* dataset_;
    uint32_t texels_per_block_;
    std::vector<Distributor*> workers_;
    std::vector<Worker> state_;
};

/// Images' samples, whose blocks are tiles, brought into the order of tiles.
SampleList list_by_tile(uint32_t tiles, const std::vector<uint32_t>& views, float scale,
                        const std::vector<ImageSamples<Sample>>& images);

/// Collects all views, a few at a time, into `waiting`: add(image, block, samples) puts there what a block takes of an
/// image, if that is anything, in the images' order and for several blocks at a time.
template <class T, class Collector, class Add>
void collect_by_block(Collector& collector, std::span<const uint32_t> views, WaitingItems<T>& waiting, const Add& add) {
    std::vector<ImageSamples<T>> images(size_t(collector.at_once()));
    for (size_t first = 0; first < views.size(); first += images.size()) {
        const size_t count = std::min(images.size(), views.size() - first);
        collector.collect(views, first, std::span(images).first(count));
        parallel_chunks(waiting.keys(), 8, [&](size_t begin, size_t end, int) {
            for (size_t k = 0; k < count; ++k)
                images[k].for_blocks(begin, end,
                                     [&](size_t block, auto samples) { add(uint32_t(first + k), block, samples); });
        });
        waiting.make_room();
    }
    waiting.close();
}

}  // namespace radiafit

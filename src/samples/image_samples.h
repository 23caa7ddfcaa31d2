#pragma once
#include <vector>

#include "samples/distributor.h"

namespace radiafit {

/// What one image leaves, in ascending texel order, so tile by tile.
struct ImageSamples {
    struct Run {
        uint32_t tile, first;  ///< first: into samples
    };
    std::vector<Run> runs;  ///< one per tile that has samples, and a sentinel whose tile is the tile count
    std::vector<Sample> samples;
    uint32_t covered_pixels = 0;
};

/// Streams images from disk, each through a distributor.
class SampleCollector {
public:
    /// `workers`: one distributor per thread to use, or a single one that is then used from the calling thread only.
    /// Throws std::invalid_argument for another number of them, or a tile of more than 65536 texels.
    SampleCollector(const Dataset& dataset, const Atlas& atlas, std::vector<Distributor*> workers, TargetSpace space);

    int at_once() const { return int(state_.size()); }  ///< images that are worked on side by side
    int bits() const { return state_.front().stream.bits(); }
    float scale() const;  ///< of Sample::rgb, one for all images
    /// Image k of `views` to out[k].
    void collect(std::span<const uint32_t> views, std::span<ImageSamples> out);

private:
    struct Worker {
        ImageStream stream;
        TargetImage image;
        Distribution distribution;
    };
    const Dataset* dataset_;
    uint32_t texels_per_tile_;
    std::vector<Distributor*> workers_;
    std::vector<Worker> state_;
};

}  // namespace radiafit

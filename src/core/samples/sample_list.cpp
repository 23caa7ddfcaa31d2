#include "samples/sample_list.h"

#include <algorithm>

#include "base/parallel.h"
#include "base/statistics.h"
#include "samples/image_samples.h"

namespace radiafit {

namespace {

void fill_statistics(const SampleList& list, const Atlas& atlas, const std::vector<ImageSamples<Sample>>& images,
                     DistributionStatistics& statistics) {
    statistics = {};
    for (const ImageBlocks& image : images) statistics.covered_pixels += image.covered_pixels;
    statistics.samples = statistics.kept_pixels = list.samples.size();
    std::vector<uint32_t> taken(atlas.texels_per_tile());
    for (uint32_t tile = 0; tile < list.tile_count(); ++tile) {
        const uint64_t begin = list.groups[list.tile_groups[tile]].first;
        const uint64_t end = list.groups[list.tile_groups[tile + 1]].first;
        std::ranges::fill(taken, 0);
        for (uint64_t s = begin; s < end; ++s) ++taken[list.samples[s].local];
        for (uint32_t local = 0; local < taken.size(); ++local) {
            if (!atlas.usable(tile * atlas.texels_per_tile() + local)) continue;
            if (taken[local] >= statistics.texels_taking.size()) statistics.texels_taking.resize(taken[local] + 1);
            ++statistics.texels_taking[taken[local]];
            ++statistics.texels;
        }
    }
    if (statistics.texels) statistics.median_samples_per_texel = median_of_counts(statistics.texels_taking);
}

}  // namespace

SampleList list_by_tile(uint32_t tiles, const std::vector<uint32_t>& views, float scale,
                        const std::vector<ImageSamples<Sample>>& images) {
    SampleList list;
    list.views = views;
    list.scale = scale;
    // Counting sort by tile, stable in the image: count, sum, place.
    list.tile_groups.assign(tiles + 1, 0);
    std::vector<uint64_t> tile_samples(tiles + 1, 0);  // where a tile's samples begin
    for (const ImageSamples<Sample>& image : images)
        image.for_blocks(0, tiles, [&](size_t tile, auto samples) {
            ++list.tile_groups[tile + 1];
            tile_samples[tile + 1] += samples.size();
        });
    for (uint32_t tile = 0; tile < tiles; ++tile) {
        list.tile_groups[tile + 1] += list.tile_groups[tile];
        tile_samples[tile + 1] += tile_samples[tile];
    }
    list.groups.resize(size_t(list.tile_groups[tiles]) + 1);
    list.groups.back() = {static_cast<uint32_t>(views.size()), tile_samples[tiles]};
    list.samples.resize(tile_samples[tiles]);

    // Each range of tiles is one worker's alone, and sees the images in order.
    parallel_chunks(tiles, 256, [&](size_t begin, size_t end, int) {
        std::vector<uint32_t> next_group(list.tile_groups.begin() + begin, list.tile_groups.begin() + end);
        std::vector<uint64_t> next_sample(tile_samples.begin() + begin, tile_samples.begin() + end);
        for (uint32_t k = 0; k < images.size(); ++k)
            images[k].for_blocks(begin, end, [&](size_t tile, auto samples) {
                uint64_t& first = next_sample[tile - begin];
                list.groups[next_group[tile - begin]++] = {k, first};
                std::copy(samples.begin(), samples.end(), list.samples.begin() + ptrdiff_t(first));
                first += samples.size();
            });
    });
    return list;
}

SampleList build_sample_list(const Dataset& dataset, const Atlas& atlas, const std::vector<uint32_t>& views,
                             std::vector<Distributor*> workers, TargetSpace space, DistributionStatistics* statistics) {
    SampleCollector collector(dataset, atlas.texels_per_tile(), std::move(workers), space);
    std::vector<ImageSamples<Sample>> images(views.size());
    collector.collect(views, 0, images);

    SampleList list = list_by_tile(atlas.tile_count(), views, collector.scale(), images);
    if (statistics) fill_statistics(list, atlas, images, *statistics);
    return list;
}

}  // namespace radiafit

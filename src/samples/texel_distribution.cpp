#include "samples/texel_distribution.h"

#include <algorithm>
#include <stdexcept>

#include "base/parallel.h"

namespace radiafit {
namespace {

/// All but the values.
void set_texels(const Distribution& distribution, TakenTexels& out) {
    const std::vector<uint32_t>& texel_pixel = distribution.texel_pixel;
    const auto texels = uint32_t(texel_pixel.size());
    out.texels.resize(texels);
    out.pixels.resize(texels);
    out.first.resize(TexelSource::texel_blocks(texels) + 1);
    uint32_t count = 0;
    for (uint32_t block = 0; block < TexelSource::texel_blocks(texels); ++block) {
        out.first[block] = count;
        const uint32_t begin = block * TexelSource::block, end = std::min(begin + TexelSource::block, texels);
        for (uint32_t texel = begin; texel < end; ++texel) {
            out.texels[count] = texel;
            out.pixels[count] = texel_pixel[texel];
            count += texel_pixel[texel] != no_pixel;  // no branch: which do is hard to foresee
        }
    }
    out.first.back() = count;
}

}  // namespace

void distribute_views(const Dataset& dataset, const std::vector<uint32_t>& views,
                      const std::vector<Distributor*>& workers,
                      const std::function<void(std::span<const TakenTexels> images)>& take) {
    if (workers.empty()) throw std::invalid_argument("distribute_views: no distributor");
    if (workers.size() > 1 && workers.size() < size_t(thread_count()))
        throw std::invalid_argument("distribute_views: fewer distributors than threads");
    struct State {
        ImageStream stream;
        TargetImage mask = {};
        Distribution distribution = {};
    };
    const size_t at_once = workers.size() == 1 ? 1 : size_t(thread_count());
    std::vector<State> states;
    for (size_t i = 0; i < at_once; ++i)
        states.push_back({ImageStream(dataset, StreamSource::disk, TargetSpace::linear)});
    std::vector<TakenTexels> taken(at_once);
    for (size_t begin = 0; begin < views.size(); begin += at_once) {
        const size_t count = std::min(at_once, views.size() - begin);
        const auto one = [&](size_t i, int worker) {
            auto& [stream, mask, distribution] = states[size_t(worker)];
            const uint32_t view = views[begin + i];
            stream.load_mask(view, mask);
            workers[size_t(worker)]->distribute(dataset.views[view].camera, mask, distribution);
            taken[i].image = uint32_t(begin + i);
            set_texels(distribution, taken[i]);
            taken[i].values.resize(3 * size_t(taken[i].count()));
            stream.values_at({taken[i].pixels.data(), taken[i].count()}, taken[i].values.data());
        };
        if (at_once == 1)
            for (size_t i = 0; i < count; ++i) one(i, 0);
        else
            parallel_for(count, 1, one);
        take({taken.data(), count});
    }
}

}  // namespace radiafit

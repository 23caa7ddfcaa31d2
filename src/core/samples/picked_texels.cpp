#include "samples/picked_texels.h"

namespace radiafit {
namespace {

/// look(texel, its samples) for ascending texels of a source, each of whose blocks is read once at most.
template <class Look>
void look_at(const TexelSource& source, std::span<const uint32_t> texels, const Look& look) {
    TexelSamples block;
    uint32_t begin = ~0u;
    for (const uint32_t t : texels) {
        const uint32_t in = t - t % TexelSource::block;
        if (in != begin) source.read(begin = in, block);
        look(t, block.of(t - begin));
    }
}

}  // namespace

uint64_t PickedTexels::sample_count() const {
    uint64_t sum = 0;
    look_at(*source_, texels_, [&](uint32_t, auto samples) { sum += samples.size(); });
    return sum;
}

void PickedTexels::read(uint32_t begin, TexelSamples& out) const {
    out.first.assign(1, 0);
    out.samples.clear();
    look_at(*source_, std::span(texels_).subspan(begin, std::min(block, texel_count() - begin)),
            [&](uint32_t, auto samples) {
                out.samples.insert(out.samples.end(), samples.begin(), samples.end());
                out.first.push_back(out.samples.size());
            });
}

TexelSamples samples_of(const TexelSource& source, std::span<const uint32_t> texels) {
    TexelSamples out;
    look_at(source, texels, [&](uint32_t t, auto samples) {
        out.first.resize(t + 1, out.samples.size());
        out.samples.insert(out.samples.end(), samples.begin(), samples.end());
    });
    out.first.resize(source.texel_count() + 1, out.samples.size());
    return out;
}

}  // namespace radiafit

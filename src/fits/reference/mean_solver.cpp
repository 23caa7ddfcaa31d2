#include "reference/mean_solver.h"

#include <array>

namespace radiafit::fits {
namespace {

struct Mean {
    std::array<double, 3> sum{};
    double count = 0;
    void add(const Mean& other) {
        for (int c = 0; c < 3; ++c) sum[c] += other.sum[c];
        count += other.count;
    }
};

}  // namespace

std::vector<float> mean_solver(const TriangleAtlas& atlas, const LfmLayout& layout, const SampleList& samples) {
    std::vector<float> p(layout.size(), 0.0f);
    for (size_t v = 0; v < layout.problem_count(); ++v)
        for (size_t at = layout.view_offset(v); at < layout.offset(v + 1); at += 4)
            for (int c = 0; c < 3; ++c) p[at + c] = 1;

    std::vector<Mean> texels(atlas.texel_count()), tiles(atlas.tile_count());
    for (uint32_t tile = 0; tile < atlas.tile_count(); ++tile) {
        const uint64_t first = samples.groups[samples.tile_groups[tile]].first;
        const uint64_t last = samples.groups[samples.tile_groups[tile + 1]].first;
        for (uint64_t i = first; i < last; ++i) {
            const Sample& s = samples.samples[i];
            Mean one{{double(s.rgb[0]), double(s.rgb[1]), double(s.rgb[2])}, 1};
            texels[tile * atlas.texels_per_tile() + s.local].add(one);
            tiles[tile].add(one);
        }
    }
    const VertexRings all(atlas.mesh(), true);
    const auto around = [&](uint32_t tile) {
        Mean mean;
        for (uint32_t v : atlas.mesh().triangles[tile])
            for (const Corner& c : all.ring(v)) mean.add(tiles[c.triangle]);
        return mean;
    };
    for (uint32_t tile = 0; tile < atlas.tile_count(); ++tile) {
        const Mean fallback = tiles[tile].count > 0 ? tiles[tile] : around(tile);
        const TriangleTile& shape = atlas.tile(tile);
        for (uint32_t local = 0; local < shape.texels(); ++local) {
            const Mean& own = texels[tile * atlas.texels_per_tile() + local];
            const Mean& mean = own.count > 0 ? own : fallback;
            if (mean.count == 0) continue;
            for (uint32_t corner = 0; corner < 3; ++corner) {
                const size_t map = layout.map_offset(tile, corner);
                if (map == LfmLayout::no_map) continue;
                for (int c = 0; c < 3; ++c)
                    p[map + local * layout.stride() + c] =
                        float(shape.barycentric(local)[corner] * samples.scale * mean.sum[c] / mean.count);
            }
        }
    }
    return p;
}

}  // namespace radiafit::fits

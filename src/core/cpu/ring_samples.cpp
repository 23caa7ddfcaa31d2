#include "cpu/ring_samples.h"

#include "base/parallel.h"

namespace radiafit {

template <class real>
TargetWeights<real>::TargetWeights(const TriangleAtlas& atlas, float scale) {
    for (uint32_t triangle = 0; triangle < atlas.tile_count(); ++triangle) {
        const TriangleTile& tile = atlas.tile(triangle);
        sides_.push_back(uint8_t(tile.side()));
        auto& weights = weights_[size_t(tile.side())];
        if (!weights[0].empty()) continue;
        for (uint32_t local = 0; local < tile.texels(); ++local)
            for (size_t corner = 0; corner < 3; ++corner)
                weights[corner].push_back(broadcast3<real>(real(tile.barycentric(local)[corner]) * real(scale)));
    }
}

template <class real>
ProblemStatistics count_rings(const VertexRings& rings, const SampleList& list, const TargetWeights<real>& weights) {
    const size_t vertices = rings.vertex_count();
    ProblemStatistics statistics{std::vector<uint32_t>(vertices), std::vector<float>(3 * vertices)};
    parallel_for(vertices, 64, [&](size_t v, int) {
        Lanes<double> sum{};
        uint32_t count = 0;
        for (const Corner& corner : rings.ring(v)) {
            const uint64_t first = list.groups[list.tile_groups[corner.triangle]].first;
            const uint64_t last = list.groups[list.tile_groups[corner.triangle + 1]].first;
            const Lanes<real>* weight = weights.of(corner, weights.side(corner));
            Lanes<real> part{};
            for (uint64_t s = first; s < last; ++s)
                part += weight[list.samples[s].local] * load_sample<real>(&list.samples[s]);
            sum += widen<real>(part);
            count += uint32_t(last - first);
        }
        statistics.samples[v] = count;
        for (int c = 0; c < 3 && count; ++c) statistics.mean[3 * v + size_t(c)] = float(sum[c] / count);
    });
    return statistics;
}

template class TargetWeights<float>;
template class TargetWeights<double>;
template ProblemStatistics count_rings(const VertexRings&, const SampleList&, const TargetWeights<float>&);
template ProblemStatistics count_rings(const VertexRings&, const SampleList&, const TargetWeights<double>&);

}  // namespace radiafit

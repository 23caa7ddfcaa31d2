#include "lightbasis/light_error_bars.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "fit/error_bar_maps.h"
#include "fit/fit_maps.h"
#include "lightbasis/by_directions.h"

namespace radiafit::fits {

LightErrorBars::LightErrorBars(const LightBasisFit& fit, const Atlas& atlas, const TexelSource& source,
                               const TexelLightReader& reader) {
    const size_t texels = atlas.texel_count(), rank = size_t(fit.basis.rank);
    deviation.resize(texels * rank);
    noise.resize(texels);
    deficient.assign(texels, uint32_t(rank));
    from_.resize(texels);
    ByDirections<std::vector<LampAndHalf>> known;
    std::vector<LightBasisSolver> solvers(size_t(thread_count()), LightBasisSolver{fit.basis});
    parallel_for(source.block_count(), 1, [&](size_t block, int worker) {
        LightBasisSolver& solver = solvers[size_t(worker)];
        const size_t begin = block * TexelSource::block, end = std::min(begin + TexelSource::block, texels);
        TexelSamples samples;
        TexelLights lights;
        source.read(uint32_t(begin), samples);
        for (size_t t = begin; t < end; ++t) {
            reader.read(uint32_t(t), samples.of(t - begin), lights);
            if (lights.size() == 0) continue;
            from_[t] = known.of(lights.directions);
            solver.look_from(fit.basis.block_at(atlas.position(uint32_t(t))), lights.directions);
            const double freedom = 3 * double(lights.size()) - double(solver.determined());
            if (!(freedom > 0)) continue;
            noise[t] = float(std::sqrt(2 * double(fit.error[t]) / freedom));
            deficient[t] = solver.deficient();
            for (size_t k = 0; k < rank; ++k) deviation[t * rank + k] = noise[t] * solver.deviation()[Eigen::Index(k)];
        }
    });
}

Vec3f LightErrorBars::of_value(uint32_t texel, size_t block, const LampAndHalf& at, LightBasisSolver& solver) const {
    if (!from_[texel] || noise[texel] == 0) return Vec3f::Constant(INFINITY);
    solver.look_from(block, *from_[texel]);
    return noise[texel] * solver.deviation_at(at);
}

void write_error_bars(const std::filesystem::path& folder, const Atlas& atlas, const LightBasisFit& fit,
                      const LightErrorBars& bars) {
    LightBasisFit own;
    own.basis.rank = fit.basis.rank;
    write_error_bars(folder, atlas, maps_of(own), {bars.deviation, bars.noise, bars.deficient});
}

}  // namespace radiafit::fits

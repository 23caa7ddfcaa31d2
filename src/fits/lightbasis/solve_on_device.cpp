#include "basis/solve_on_device.h"

#include <algorithm>

#include "lightbasis/solve_light_basis.h"

namespace radiafit::fits {

LightBasisSolution solve_on_device(const Atlas& atlas, const TexelSource& source, const TexelLightReader& reader,
                                   const LightBasis& basis) {
    LightBasisSolution out(atlas.texel_count(), basis.rank);
    const auto read = [&](size_t block, std::vector<DeviceTexel>& texels) {
        const uint32_t begin = uint32_t(block) * TexelSource::block;
        TexelSamples samples;
        TexelLights lights;
        source.read(begin, samples);
        texels.clear();
        for (uint32_t t = begin; t < std::min(begin + TexelSource::block, source.texel_count()); ++t) {
            reader.read(t, samples.of(t - begin), lights);
            out.samples[t] = uint32_t(lights.size());
            if (lights.size() == 0) continue;
            DeviceTexel texel{t, uint32_t(basis.block_at(atlas.position(t))), {}, {}};
            for (size_t i = 0; i < lights.size(); ++i)
                texel.samples.push_back({lights.directions[i].lamp, lights.values[i]});
            if (basis.by_half())
                for (const LampAndHalf& at : lights.directions) texel.halves.push_back(at.half);
            texels.push_back(std::move(texel));
        }
    };
    const auto take = [&](uint32_t texel, std::span<const float> z, float error) {
        std::ranges::copy(z, &out.parameters[texel * z.size()]);
        out.error[texel] = error;
    };
    const size_t samples_each = source.sample_count() / std::max<size_t>(1, source.block_count());
    const LampFunctions functions(basis, sample_smoothing);
    std::vector<float> numbers;
    for (size_t b = 0; b < basis.cubes.size(); ++b) {
        const auto all = functions.block(b).reshaped<Eigen::RowMajor>();
        numbers.insert(numbers.end(), all.begin(), all.end());
    }
    std::vector<Vec3f> lamps, halves;
    for (const LampAndHalf& at : basis.lamps) lamps.push_back(at.lamp);
    for (const LampAndHalf& at : basis.lamps)
        if (basis.by_half()) halves.push_back(at.half);
    solve_on_device(
        {numbers, basis.rank, basis.noise, lamps, basis.length, halves, basis.half_length, basis.half_share},
        {.count = source.block_count(),
         .size_of =
             [&](size_t) {
                 return DeviceUnits::Size{samples_each, TexelSource::block};
             },
         .read = read,
         .take = take});
    return out;
}

}  // namespace radiafit::fits

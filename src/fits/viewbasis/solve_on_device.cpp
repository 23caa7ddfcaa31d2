#include "basis/solve_on_device.h"

#include <algorithm>

#include "viewbasis/solve_view_basis.h"

namespace radiafit::fits {

ViewBasisSolution solve_on_device(const Dataset& dataset, const TriangleAtlas& atlas, const SampleList& samples,
                                  const ViewBasis& basis) {
    ViewBasisSolution out(atlas.texel_count(), basis.rank);
    const TexelViewReader reader(dataset, atlas, samples, basis.up);
    const auto first = [&](size_t tile) { return samples.groups[samples.tile_groups[tile]].first; };
    const auto read = [&](size_t tile, std::vector<DeviceTexel>& texels) {
        std::vector<std::vector<TexelView>> views;
        reader.read(uint32_t(tile), views);
        texels.clear();
        for (uint32_t l = 0; l < views.size(); ++l) {
            const uint32_t t = uint32_t(tile) * atlas.texels_per_tile() + l;
            out.samples[t] = uint32_t(views[l].size());
            if (!views[l].empty())
                texels.push_back({t, uint32_t(basis.block_at(atlas.position(t))), std::move(views[l])});
        }
    };
    const auto take = [&](uint32_t texel, std::span<const float> z, float error) {
        std::ranges::copy(z, &out.parameters[texel * z.size()]);
        out.error[texel] = error;
    };
    solve_on_device(
        {basis.numbers, basis.rank, basis.noise},
        {.count = atlas.tile_count(),
         .size_of =
             [&](size_t tile) {
                 return DeviceUnits::Size{first(tile + 1) - first(tile), size_t(atlas.tile(uint32_t(tile)).texels())};
             },
         .read = read,
         .take = take});
    return out;
}

}  // namespace radiafit::fits

#include <map>

#include "base/parallel.h"
#include "gl/context.h"
#include "gl/group_trial.h"
#include "gl/program.h"
#include "viewbasis/solve_view_basis.h"

namespace radiafit::fits {
namespace {

constexpr size_t floats_at_once = size_t(1) << 22;  ///< of samples and solutions

/// As the shader has it.
struct Texel {
    uint32_t first_sample, samples, block, number;
};

}  // namespace

uint64_t bytes_on_device() { return 3 * floats_at_once * sizeof(float); }

ViewBasisSolution solve_on_device(const Dataset& dataset, const TriangleAtlas& atlas, const SampleList& samples,
                                  const ViewBasis& basis) {
    ViewBasisSolution out(atlas.texel_count(), basis.rank);
    const TexelViewReader reader(dataset, atlas, samples, basis.up);
    const size_t z = 3 * size_t(basis.rank), numbers = z + 1;
    const size_t columns = size_t(basis.rank) + 3;  // as the shader has them
    const Buffer functions(basis.numbers);
    std::map<size_t, Program> programs;  // by invocations of a work group
    const auto program_of = [&](size_t usual) -> Program& {
        const size_t lanes =
            Context::current().group_size(usual, 4 * (columns + 1), 2 * columns * (columns + 1) + 12 * view_terms);
        Program& program = programs[lanes];
        if (!program) {
            program = Program::compute("compute/view_basis.comp",
                                       {{"LANES", std::to_string(lanes)}, {"RANK", std::to_string(basis.rank)}});
            program.bind("Basis", functions);
            program.set("noise", basis.noise);
        }
        return program;
    };
    size_t usual = group_size_is_open() ? 0 : 64;  // 0: tried with the first texels
    std::vector<std::vector<std::vector<TexelView>>> tiles;
    for (uint32_t begin = 0, end = 0; begin < atlas.tile_count(); begin = end) {
        for (size_t floats = 0; end < atlas.tile_count() && floats < floats_at_once; ++end) {
            const auto first = [&](uint32_t tile) { return samples.groups[samples.tile_groups[tile]].first; };
            floats += 6 * (first(end + 1) - first(end)) + (4 + numbers) * atlas.tile(end).texels();
        }
        tiles.resize(std::max<size_t>(tiles.size(), end - begin));
        parallel_for(end - begin, 16, [&](size_t i, int) { reader.read(begin + uint32_t(i), tiles[i]); });
        std::vector<Texel> texels;
        std::vector<TexelView> seen;
        for (uint32_t tile = begin; tile < end; ++tile)
            for (uint32_t l = 0; l < tiles[tile - begin].size(); ++l) {
                const auto& views = tiles[tile - begin][l];
                const uint32_t t = tile * atlas.texels_per_tile() + l, count = uint32_t(views.size());
                out.samples[t] = count;
                if (count == 0) continue;
                texels.push_back({uint32_t(seen.size()), count, uint32_t(basis.block_at(atlas.position(t))), t});
                seen.insert(seen.end(), views.begin(), views.end());
            }
        if (texels.empty()) continue;
        std::vector<float> solved(texels.size() * numbers);
        const Buffer of_texels(texels), of_samples(seen), solutions(solved);
        const auto solve = [&](size_t invocations) {
            const Program& program = program_of(invocations);
            program.bind("Texels", of_texels);
            program.bind("Samples", of_samples);
            program.bind("Solutions", solutions);
            program.set("texel_count", int(texels.size()));
            program.dispatch(texels.size());
        };
        if (usual == 0) usual = best_group(try_groups(solve));
        solve(usual);
        solutions.read(0, solved.size() * sizeof(float), solved.data());
        for (size_t i = 0; i < texels.size(); ++i) {
            std::copy_n(&solved[i * numbers], z, &out.parameters[texels[i].number * z]);
            out.error[texels[i].number] = solved[i * numbers + z];
        }
    }
    return out;
}

}  // namespace radiafit::fits

#include "basis/basis_texels.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <unordered_map>
#include <utility>

#include "base/rng.h"

namespace radiafit::fits {
namespace {

constexpr uint64_t draw_seed = 1;

/// At most `count` of the numbers below `all`, evenly: the first of a shuffled list (Fisher and Yates), of which only
/// entries that were looked at are held.
std::vector<uint64_t> drawn(uint64_t all, size_t count, uint64_t stream) {
    std::vector<uint64_t> out(std::min<uint64_t>(all, count));
    std::unordered_map<uint64_t, uint64_t> held;
    const auto at = [&](uint64_t i) -> uint64_t& { return held.try_emplace(i, i).first->second; };
    Rng rng(draw_seed, stream);
    for (size_t i = 0; i < out.size(); ++i) {
        if (all > count) std::swap(at(i), at(i + rng.index(uint32_t(all - i))));
        out[i] = at(i);
    }
    return out;
}

/// Side of cubes of which about so many hold some of the surface.
float cube_side(double area, int blocks) {
    if (blocks <= 1) return 0;
    return float(std::sqrt(1.5 * area / blocks));  // a plane across a cube at random has about 1.5 times a face's area
}

}  // namespace

SurfaceExtent extent_of(const Mesh& mesh) {
    SurfaceExtent out;
    for (const auto& [a, b, c] : mesh.triangles) {
        const Vec3d first = mesh.positions[a].cast<double>();
        out.area +=
            0.5 * (mesh.positions[b].cast<double>() - first).cross(mesh.positions[c].cast<double>() - first).norm();
    }
    if (!mesh.positions.empty()) out.origin = mesh.positions[0];
    for (const Vec3f& p : mesh.positions) out.origin = out.origin.cwiseMin(p);
    return out;
}

SurfaceExtent extent_of(const Grid& grid) {
    const Vec3d first = grid.position(0, 0), last = grid.position(grid.width - 1, grid.height - 1),
                right = grid.position(grid.width - 1, 0), down = grid.position(0, grid.height - 1);
    return {first.cwiseMin(last).cwiseMin(right).cwiseMin(down).cast<float>(),
            double(grid.texel_count()) * grid.right.norm() * grid.down.norm()};
}

std::vector<bool> BasisTexels::mask(const Atlas& atlas) const {
    std::vector<bool> out(atlas.texel_count());
    for (const uint32_t texel : everywhere) out[texel] = true;
    for (const auto& texels : of_block)
        for (const uint32_t texel : texels) out[texel] = true;
    return out;
}

BasisTexels draw_basis_texels(const Atlas& atlas, const SurfaceExtent& extent, size_t everywhere, int blocks,
                              size_t per_block) {
    BasisTexels out;
    out.blocks.origin = extent.origin;
    out.blocks.cube = cube_side(extent.area, blocks);

    // Usable texels have numbers: cube by cube, then as the atlas has them.
    std::map<std::array<int32_t, 3>, uint64_t> cubes;  // how many are in each, and then the next one's number
    const auto for_usable = [&](const auto& body) {
        for (uint32_t texel = 0; texel < atlas.texel_count(); ++texel)
            if (atlas.usable(texel))
                body(cubes[cube_at(atlas.position(texel), out.blocks.origin, out.blocks.cube)], texel);
    };
    for_usable([](uint64_t& texels, uint32_t) { ++texels; });
    std::unordered_multimap<uint64_t, uint32_t*> wanted;  // by number
    const auto draw = [&](uint64_t first, uint64_t texels, size_t count, uint64_t stream, std::vector<uint32_t>& to) {
        const std::vector<uint64_t> numbers = drawn(texels, count, stream);
        to.resize(numbers.size());
        for (size_t i = 0; i < numbers.size(); ++i) wanted.emplace(first + numbers[i], &to[i]);
    };
    uint64_t all = 0;
    if (out.blocks.cube > 0) out.of_block.resize(cubes.size());
    for (auto& [cube, number] : cubes) {
        const uint64_t texels = std::exchange(number, all), block = out.blocks.cubes.size();
        if (out.blocks.cube > 0) draw(all, texels, per_block, 1 + block, out.of_block[block]);
        all += texels;
        out.blocks.cubes.push_back(cube);
    }
    draw(0, all, everywhere, 0, out.everywhere);
    for_usable([&](uint64_t& number, uint32_t texel) {
        const auto [begin, end] = wanted.equal_range(number++);
        for (auto to = begin; to != end; ++to) *to->second = texel;
    });
    return out;
}

}  // namespace radiafit::fits

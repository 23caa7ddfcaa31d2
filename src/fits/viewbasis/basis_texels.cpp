#include "viewbasis/basis_texels.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <unordered_map>
#include <utility>

#include "base/rng.h"

namespace radiafit::fits {
namespace {

using Place = BasisTexels::Place;

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
float cube_side(const Mesh& mesh, int blocks) {
    if (blocks <= 1) return 0;
    double area = 0;
    for (const auto& [a, b, c] : mesh.triangles) {
        const Vec3d origin = mesh.positions[a].cast<double>();
        area +=
            0.5 * (mesh.positions[b].cast<double>() - origin).cross(mesh.positions[c].cast<double>() - origin).norm();
    }
    return float(std::sqrt(1.5 * area / blocks));  // a plane across a cube at random has about 1.5 times a face's area
}

}  // namespace

std::vector<bool> BasisTexels::mask(const TriangleAtlas& atlas) const {
    std::vector<bool> out(atlas.texel_count());
    const auto add = [&](const std::vector<Place>& places) {
        for (const auto& [tile, local] : places) out[size_t(tile) * atlas.texels_per_tile() + local] = true;
    };
    add(everywhere);
    for (const auto& places : of_block) add(places);
    return out;
}

BasisTexels draw_basis_texels(const TriangleAtlas& atlas, size_t everywhere, int blocks) {
    BasisTexels out;
    const Mesh& mesh = atlas.mesh();
    out.cube = cube_side(mesh, blocks);
    if (!mesh.positions.empty()) out.origin = mesh.positions[0];
    for (const Vec3f& p : mesh.positions) out.origin = out.origin.cwiseMin(p);

    // Usable texels have numbers: cube by cube, then as the atlas has them.
    std::map<std::array<int32_t, 3>, uint64_t> cubes;  // how many are in each, and then the next one's number
    const auto for_usable = [&](const auto& body) {
        for (uint32_t t = 0; t < atlas.tile_count(); ++t)
            for (uint32_t l = 0; l < atlas.tile(t).texels() && !atlas.degenerate(t); ++l)
                body(cubes[cube_at(atlas.position(t, l), out.origin, out.cube)], Place{t, l});
    };
    for_usable([](uint64_t& texels, const Place&) { ++texels; });
    std::unordered_multimap<uint64_t, Place*> wanted;  // by number
    const auto draw = [&](uint64_t first, uint64_t texels, size_t count, uint64_t stream, std::vector<Place>& to) {
        const std::vector<uint64_t> numbers = drawn(texels, count, stream);
        to.resize(numbers.size());
        for (size_t i = 0; i < numbers.size(); ++i) wanted.emplace(first + numbers[i], &to[i]);
    };
    uint64_t all = 0;
    if (out.cube > 0) out.of_block.resize(cubes.size());
    for (auto& [cube, number] : cubes) {
        const uint64_t texels = std::exchange(number, all), block = out.cubes.size();
        if (out.cube > 0) draw(all, texels, texels_per_block, 1 + block, out.of_block[block]);
        all += texels;
        out.cubes.push_back(cube);
    }
    draw(0, all, everywhere, 0, out.everywhere);
    for_usable([&](uint64_t& number, const Place& place) {
        const auto [begin, end] = wanted.equal_range(number++);
        for (auto to = begin; to != end; ++to) *to->second = place;
    });
    return out;
}

}  // namespace radiafit::fits

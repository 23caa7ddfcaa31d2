#include "basis/basis_blocks.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "base/json.h"

namespace radiafit::fits {

using Json = nlohmann::ordered_json;

std::array<int32_t, 3> cube_at(const Vec3f& position, const Vec3f& origin, float side) {
    std::array<int32_t, 3> cube{};
    for (int k = 0; k < 3 && side > 0; ++k) cube[size_t(k)] = int32_t(std::floor((position[k] - origin[k]) / side));
    return cube;
}

size_t BasisBlocks::block_at(const Vec3f& position) const {
    const auto cube = cube_at(position, origin, this->cube);
    const auto found = std::ranges::lower_bound(cubes, cube);
    return found != cubes.end() && *found == cube ? size_t(found - cubes.begin()) : 0;
}

std::string description_of(const BasisBlocks& blocks) {
    return json_text(
        Json{{"origin", numbers_of(blocks.origin)}, {"cube", double(blocks.cube)}, {"cubes", blocks.cubes}});
}

BasisBlocks described_blocks(const std::string& json) {
    const Json own = parse_json<Json>(json);
    BasisBlocks b;
    b.origin = vector_of(own.at("origin"));
    b.cube = own.at("cube").get<float>();
    b.cubes = own.at("cubes").get<std::vector<std::array<int32_t, 3>>>();
    if (b.cubes.empty() || b.cubes.size() > 1'000'000 || !std::ranges::is_sorted(b.cubes) || !(b.cube >= 0))
        throw std::runtime_error("its cubes are none, or in no order");
    return b;
}

std::array<double, 3> numbers_of(const Vec3f& v) { return {double(v.x()), double(v.y()), double(v.z())}; }

Vec3f vector_of(const std::vector<float>& v) {
    if (v.size() != 3 || !std::ranges::all_of(v, [](float x) { return std::isfinite(x); }))
        throw std::runtime_error("a vector has not three numbers");
    return {v[0], v[1], v[2]};
}

}  // namespace radiafit::fits

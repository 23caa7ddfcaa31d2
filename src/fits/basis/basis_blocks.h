#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "base/linear.h"
#include "base/rings.h"

namespace radiafit::fits {

/// Cubes of space, each with a basis of its own for the surface in it.
struct BasisBlocks {
    Vec3f origin = Vec3f::Zero();
    float cube = 0;                             ///< side of the cubes, in the surface's unit; 0: one basis for all
    std::vector<std::array<int32_t, 3>> cubes;  ///< ascending; those that hold a surface; one at least
    std::vector<float> numbers;                 ///< of each cube's basis, as many for one as for another

    /// The block of a place on the surface; the first where it lies in none.
    size_t block_at(const Vec3f& position) const;
};

/// The cube that a place is in.
std::array<int32_t, 3> cube_at(const Vec3f& position, const Vec3f& origin, float side);

/// All but the numbers, as a JSON object.
std::string description_of(const BasisBlocks& blocks);
/// The same the other way round, among whatever else the object says; throws std::runtime_error or what nlohmann
/// throws.
BasisBlocks described_blocks(const std::string& json);

/// Three numbers, as JSON takes and gives them. Throws std::runtime_error unless they are three, and finite.
std::array<double, 3> numbers_of(const Vec3f& v);
Vec3f vector_of(const std::vector<float>& numbers);

}  // namespace radiafit::fits

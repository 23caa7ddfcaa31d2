#include "viewbasis/view_basis.h"

#include <algorithm>
#include <cmath>

namespace radiafit::fits {

ViewTerms view_polynomials(const Vec3f& direction) {
    return ViewTerms::Map(ViewText::view_terms({direction.x(), direction.y(), direction.z()}).x);
}

std::array<int32_t, 3> cube_at(const Vec3f& position, const Vec3f& origin, float side) {
    std::array<int32_t, 3> cube{};
    for (int k = 0; k < 3 && side > 0; ++k) cube[size_t(k)] = int32_t(std::floor((position[k] - origin[k]) / side));
    return cube;
}

size_t ViewBasis::block_at(const Vec3f& position) const {
    const auto cube = cube_at(position, origin, this->cube);
    const auto found = std::ranges::lower_bound(cubes, cube);
    return found != cubes.end() && *found == cube ? size_t(found - cubes.begin()) : 0;
}

}  // namespace radiafit::fits

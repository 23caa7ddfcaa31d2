#include "viewbasis/view_basis.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace radiafit {

Frame view_frame(const Vec3f& normal, const Vec3f& up) {
    const Vec3f across = up.cross(normal);
    const float length = across.norm();
    if (!(length > 1e-6f)) return make_frame(normal);
    return {across / length, normal.cross(across / length), normal};
}

ViewTerms view_polynomials(const Vec3f& direction) {
    const auto terms = view_text::ViewPolynomials<float>::view_terms({direction.x(), direction.y(), direction.z()});
    return ViewTerms::Map(terms.x);
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

}  // namespace radiafit

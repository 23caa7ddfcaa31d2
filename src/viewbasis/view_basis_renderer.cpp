#include "viewbasis/texel_contestant.h"
#include "viewbasis/view_basis_fit.h"

namespace radiafit {

Contestant contestant_of(const ViewBasisFit& fit, const TriangleAtlas& atlas) {
    return texel_contestant(atlas, fit.surface, fit.space, [&fit, &atlas](uint32_t texel, const Vec3f& eye) {
        const Vec3f position = atlas.position(texel);
        const BlockBasis& block = fit.basis.blocks[fit.basis.block_at(position)];
        const Frame frame = view_frame(atlas.normal(texel), fit.basis.up);
        const ViewTerms b = view_polynomials(view_direction(frame, position, eye));
        const Eigen::Index rank = fit.basis.rank;
        const Eigen::Map<const Eigen::Matrix<float, 3, Eigen::Dynamic>> z(
            &fit.parameters[size_t(texel) * size_t(rank) * 3], 3, rank);
        return Vec3f(block.mean.transpose() * b + z * (block.u.transpose() * b));
    });
}

}  // namespace radiafit

#include "base/parallel.h"
#include "viewbasis/texel_views.h"
#include "viewbasis/view_basis_fit.h"

namespace radiafit {
namespace {

class ViewBasisRenderer {
public:
    ViewBasisRenderer(const ViewBasisFit& fit, const TriangleAtlas& atlas) : fit_(&fit), atlas_(&atlas) {}

    void shade(const Camera& camera, const std::vector<RasterPixel>& pixels, std::vector<float>& rgb) const {
        rgb.assign(3 * pixels.size(), 0.0f);
        const Vec3f eye = camera.center().cast<float>();
        uint32_t last = no_texel;  // neighbouring pixels mostly share one
        Vec3f colour = Vec3f::Zero();
        for (size_t i = 0; i < pixels.size(); ++i) {
            if (pixels[i].triangle == no_triangle) continue;
            const uint32_t texel = pixels[i].triangle * atlas_->texels_per_tile() +
                                   atlas_->local_at(pixels[i].triangle, pixels[i].b1, pixels[i].b2);
            if (texel != last) colour = colour_of(texel, eye);
            last = texel;
            Vec3f::Map(&rgb[3 * i]) = colour;
        }
    }

private:
    Vec3f colour_of(uint32_t texel, const Vec3f& eye) const {
        const Vec3f position = atlas_->position(texel);
        const BlockBasis& block = fit_->basis.blocks[fit_->basis.block_at(position)];
        const Frame frame = view_frame(atlas_->normal(texel), fit_->basis.up);
        const ViewTerms b = view_polynomials(view_direction(frame, position, eye));
        const Eigen::Index rank = fit_->basis.rank;
        const Eigen::Map<const Eigen::Matrix<float, 3, Eigen::Dynamic>> z(
            &fit_->parameters[size_t(texel) * size_t(rank) * 3], 3, rank);
        return block.mean.transpose() * b + z * (block.u.transpose() * b);
    }

    const ViewBasisFit* fit_;
    const TriangleAtlas* atlas_;
};

}  // namespace

Contestant contestant_of(const ViewBasisFit& fit, const TriangleAtlas& atlas) {
    return {[renderer = ViewBasisRenderer(fit, atlas)](const View& view, const auto& pixels, std::vector<float>& rgb,
                                                       int) { renderer.shade(view.camera, pixels, rgb); },
            fit.space};
}

}  // namespace radiafit

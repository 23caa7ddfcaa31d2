#include "eval/reflectance_renderer.h"

#include <stdexcept>

#include "dataset/texel_shading.h"

namespace radiafit {

ReflectanceRenderer::ReflectanceRenderer(const Atlas& atlas, const ReflectanceFit& fit)
    : atlas_(&atlas), texel_of_(atlas), fit_(&fit) {
    if (fit.parameters.size() != size_t(atlas.texel_count()) * size_t(fit.options.model->parameters))
        throw std::invalid_argument("ReflectanceRenderer: a fit of another atlas");
}

void ReflectanceRenderer::shade(const View& view, const std::vector<RasterPixel>& pixels,
                                std::vector<float>& rgb) const {
    const size_t n = size_t(fit_->options.model->parameters);
    rgb.assign(3 * pixels.size(), 0.0f);
    for (size_t i = 0; i < pixels.size(); ++i) {
        if (pixels[i].triangle == no_triangle) continue;
        const uint32_t texel = texel_of(pixels[i]);
        if (fit_->samples[texel] == 0) continue;
        const TexelShading::Lit lit = TexelShading::lit(TexelShading::place(*atlas_, texel), view);
        const Vec3f value = shown_value(fit_->options, {&fit_->parameters[texel * n], n}, lit.u, lit.v);
        Vec3f::Map(&rgb[3 * i]) = value.cwiseProduct(lit.irradiance);
    }
}

}  // namespace radiafit

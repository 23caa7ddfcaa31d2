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
    const TexelModel& model = *fit_->options.model;
    const size_t n = size_t(model.parameters);
    rgb.assign(3 * pixels.size(), 0.0f);
    for (size_t i = 0; i < pixels.size(); ++i) {
        if (pixels[i].triangle == no_triangle) continue;
        const uint32_t texel = texel_of(pixels[i]);
        if (fit_->samples[texel] == 0) continue;
        const TexelShading::Lit lit = TexelShading::lit(TexelShading::place(*atlas_, texel), view);
        const auto value = model.value({&fit_->parameters[texel * n], n}, lit.u, lit.v);
        for (size_t c = 0; c < 3; ++c) rgb[3 * i + c] = value[c] * lit.irradiance[int(c)];
    }
}

}  // namespace radiafit

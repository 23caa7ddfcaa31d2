#include "synthetic/render_reflectance.h"

#include "synthetic/ornament_pattern.h"

namespace radiafit {

Vec3d reflected(const TexelSurface& surface, uint32_t texel, const Vec3d& x, const Vec3d& eye, const Light& light) {
    const Angles angles =
        Angles::of(surface.atlas.normal(texel).cast<double>(), light.direction_from(x), (eye - x).normalized());
    const auto model = model_of(OrnamentMaterial(surface.truth.material[texel]));
    return light.irradiance_at(x).cwiseProduct(reflect(model, surface.truth.parameters[texel], angles));
}

void TexelSurfaceRenderer::render(const TexelSurface& surface, const Camera& camera, const Light& light,
                                  Shading shading, LinearImage& image) {
    const TriangleAtlas& atlas = surface.atlas;
    const Vec3d eye = camera.center();
    render_samples(rasterizer_, atlas.mesh(), camera, shading == Shading::texel ? 1 : supersamples, image,
                   [&](const RasterPixel& seen) -> Vec3f {
                       const uint32_t local = atlas.local_at(seen.triangle, seen.b1, seen.b2);
                       const uint32_t texel = seen.triangle * atlas.texels_per_tile() + local;
                       const Vec3f x = shading == Shading::texel ? atlas.position(texel) : point_of(atlas.mesh(), seen);
                       return reflected(surface, texel, x.cast<double>(), eye, light).cast<float>();
                   });
}

}  // namespace radiafit

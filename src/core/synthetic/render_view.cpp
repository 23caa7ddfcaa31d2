#include "synthetic/render_view.h"

#include <algorithm>
#include <cmath>

namespace radiafit {
namespace {

float schlick(float cosine) {
    const float m = 1 - cosine, m2 = m * m;
    return m2 * m2 * m;
}

/// Radiance towards `view` (unit) of a coated point: diffuse ground, a GGX lobe per lamp (Walter et al. 2007, with
/// Kelemen's visibility term) and the sky's mirror image.
Vec3f shade(const PointLight& light, const Paint::Coat& coat, const Vec3f& view) {
    const Gloss& gloss = *coat.gloss;
    const Vec3f normal = light.normal.normalized();
    const float n_v = std::max(normal.dot(view), 0.02f);
    const Vec3f f0 = gloss.reflectance * (gloss.metal * coat.color + Vec3f::Constant(1 - gloss.metal));
    Vec3f radiance = (1 - gloss.metal) * (1 - gloss.reflectance) * light.irradiance.cwiseProduct(coat.color);
    const float a2 = gloss.roughness * gloss.roughness;
    for (size_t l = 0; l < lamp_count; ++l) {
        const Lamp& lamp = lamps()[l];
        const float n_l = normal.dot(lamp.direction);
        if (n_l <= 0 || light.lamp_visible[l] <= 0) continue;
        const Vec3f half = (lamp.direction + view).normalized();
        const float n_h = normal.dot(half), l_h = std::max(lamp.direction.dot(half), 0.1f);
        const float peak = n_h * n_h * (a2 - 1) + 1;
        // pi D: a lamp's `radiance` is that of a white diffuse surface, irradiance / pi.
        const float lobe = a2 / (peak * peak) * 0.25f / (l_h * l_h) * n_l * light.lamp_visible[l];
        const Vec3f fresnel = f0 + schlick(l_h) * (Vec3f::Ones() - f0);
        radiance += lobe * lamp.radiance.cwiseProduct(fresnel);
    }
    const Vec3f fresnel = f0 + schlick(n_v) * (1 - gloss.roughness) * (Vec3f::Ones() - f0);
    const Vec3f mirrored = 2 * normal.dot(view) * normal - view;
    radiance += light.sky_visible * fresnel.cwiseProduct(sky(mirrored));
    return radiance;
}

}  // namespace

Vec3f point_of(const Mesh& mesh, const RasterPixel& seen) {
    const auto& t = mesh.triangles[seen.triangle];
    return (1 - seen.b1 - seen.b2) * mesh.positions[t[0]] + seen.b1 * mesh.positions[t[1]] +
           seen.b2 * mesh.positions[t[2]];
}

void ViewRenderer::render(const Scene& scene, const Camera& camera, int samples, LinearImage& image) {
    const Vec3f eye = camera.center().cast<float>();
    render_samples(rasterizer_, scene.mesh, camera, samples, image, [&](const RasterPixel& seen) {
        const Vec3f x = point_of(scene.mesh, seen);
        return shade(scene.light.at(seen.triangle, seen.b1, seen.b2), scene.paint.at(seen.triangle, x),
                     (eye - x).normalized());
    });
}

void render_samples(Rasterizer& rasterizer, const Mesh& mesh, const Camera& camera, int samples, LinearImage& image,
                    const std::function<Vec3f(const RasterPixel& seen)>& radiance) {
    Camera fine = camera;
    fine.width *= samples;
    fine.height *= samples;
    fine.fx *= samples;
    fine.fy *= samples;
    fine.cx *= samples;
    fine.cy *= samples;
    rasterizer.draw(mesh, fine);

    const auto per_axis = size_t(samples);
    const size_t width = size_t(camera.width), height = size_t(camera.height), fine_width = width * per_axis;
    image.pixels.assign(width * height, Vec3f::Zero());
    image.foreground.assign(width * height, 0);
    for (size_t y = 0; y < height; ++y)
        for (size_t x = 0; x < width; ++x) {
            const RasterPixel* block = rasterizer.pixels().data() + y * per_axis * fine_width + x * per_axis;
            Vec3f sum = Vec3f::Zero();
            int hits = 0;
            for (size_t sy = 0; sy < per_axis; ++sy)
                for (size_t sx = 0; sx < per_axis; ++sx) {
                    const RasterPixel& seen = block[sy * fine_width + sx];
                    if (seen.triangle == no_triangle) continue;
                    sum += radiance(seen);
                    ++hits;
                }
            if (hits == 0) continue;
            const size_t middle = per_axis / 2;
            const bool foreground = block[middle * fine_width + middle].triangle != no_triangle;
            image.pixels[y * width + x] = sum / float(foreground ? hits : per_axis * per_axis);
            image.foreground[y * width + x] = foreground ? 1 : 0;
        }
}

}  // namespace radiafit

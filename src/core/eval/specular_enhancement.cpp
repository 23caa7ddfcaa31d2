#include "eval/specular_enhancement.h"

#include <memory>
#include <stdexcept>

#include "eval/texel_of_pixel.h"
#include "model/prelude.h"

namespace radiafit {
namespace {

using std::max, std::min, std::pow, std::sqrt;

struct EnhancementText {
    using real = float;
    using real3 = shared_text::real3_t<real>;
#include "model/specular_enhancement.glsl"
};

EnhancementText::real3 numbers_of(const Vec3f& v) { return {v.x(), v.y(), v.z()}; }

}  // namespace

Vec3f enhanced_light(const Vec3f& light, const Vec3f& normal, const Vec3f& to_lamp, const Vec3f& to_viewer,
                     const SpecularEnhancement& by) {
    const auto out = EnhancementText::enhanced_light(numbers_of(light), numbers_of(normal), numbers_of(to_lamp),
                                                     numbers_of(to_viewer),
                                                     {float(by.diffuse), float(by.highlight), float(by.exponent)});
    return {out.x, out.y, out.z};
}

Contestant enhanced(Contestant shown, const SpecularEnhancement& by, const Atlas& atlas, std::vector<Vec3f> normals) {
    if (shown.space != TargetSpace::linear) throw std::invalid_argument("enhanced: a contestant of stored values");
    if (normals.size() != atlas.texel_count()) throw std::invalid_argument("enhanced: normals of another atlas");
    if (by.changes_nothing()) return shown;
    const auto shared = std::make_shared<const std::vector<Vec3f>>(std::move(normals));
    Contestant out;
    out.space = TargetSpace::linear;
    out.share_of_fit = shown.share_of_fit;
    out.shade = [shade = std::move(shown.shade), by, &atlas, shared, texel_of = TexelOfPixel(atlas)](
                    const View& view, const auto& pixels, std::vector<float>& rgb, int worker) {
        shade(view, pixels, rgb, worker);
        for (size_t i = 0; i < pixels.size(); ++i) {
            if (pixels[i].triangle == no_triangle) continue;
            const uint32_t texel = texel_of(pixels[i]);
            const Vec3d place = atlas.position(texel).cast<double>();
            auto light = Vec3f::Map(&rgb[3 * i]);
            light = enhanced_light(light, (*shared)[texel], view.light->direction_from(place).cast<float>(),
                                   view.direction_to_camera(place).cast<float>(), by);
        }
    };
    return out;
}

}  // namespace radiafit

#pragma once
#include "eval/contestant.h"
#include "viewbasis/texel_views.h"

namespace radiafit {

/// Of fits that have colours by view direction in each texel: colour_of(texel, eye) is a texel's, seen from a camera.
/// A pixel shows its texel's. The atlas must outlive the contestant.
template <class ColourOf>
Contestant texel_contestant(const TriangleAtlas& atlas, TargetSpace space, ColourOf colour_of) {
    const auto shade = [&atlas, colour_of](const View& view, const std::vector<RasterPixel>& pixels,
                                           std::vector<float>& rgb, int) {
        rgb.assign(3 * pixels.size(), 0.0f);
        const Vec3f eye = view.camera.center().cast<float>();
        uint32_t last = no_texel;  // neighbouring pixels mostly share one
        Vec3f colour = Vec3f::Zero();
        for (size_t i = 0; i < pixels.size(); ++i) {
            if (pixels[i].triangle == no_triangle) continue;
            const uint32_t texel = pixels[i].triangle * atlas.texels_per_tile() +
                                   atlas.local_at(pixels[i].triangle, pixels[i].b1, pixels[i].b2);
            if (texel != last) colour = colour_of(texel, eye);
            last = texel;
            Vec3f::Map(&rgb[3 * i]) = colour;
        }
    };
    return {shade, space};
}

}  // namespace radiafit

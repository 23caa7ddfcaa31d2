#pragma once
#include <memory>

#include "base/parallel.h"
#include "eval/contestant.h"
#include "eval/shown_texels.h"
#include "geometry/surface_lookup.h"
#include "viewbasis/texel_views.h"

namespace radiafit::fits {

/// For fits that have colours by view direction in each texel: colour_of(texel, eye) is a texel's, seen from a camera.
/// A pixel shows the mix of those texels that the look-up names. The atlas must outlive the contestant.
template <class ColourOf>
Contestant texel_contestant(const TriangleAtlas& atlas, SurfaceLookup lookup, TargetSpace space, ColourOf colour_of) {
    const auto of_workers = std::make_shared<std::vector<ShownTexels<Vec3f>>>(size_t(thread_count()));
    const auto shade = [&atlas, find = TexelLookup(atlas, lookup), colour_of, of_workers](
                           const View& view, const std::vector<RasterPixel>& pixels, std::vector<float>& rgb,
                           int worker) {
        rgb.assign(3 * pixels.size(), 0.0f);
        const Vec3f eye = view.camera.center().cast<float>();
        ShownTexels<Vec3f>& shown = of_workers->at(size_t(worker));
        shown.begin(pixels.size());
        for (size_t i = 0; i < pixels.size(); ++i) {
            if (pixels[i].triangle == no_triangle) continue;
            const TexelMix mix = find.at(pixels[i].triangle, pixels[i].b1, pixels[i].b2);
            Vec3f colour = Vec3f::Zero();
            for (const auto& [triangle, local, weight] : mix.entries()) {
                const uint32_t texel = triangle * atlas.texels_per_tile() + local;
                colour += weight * shown.of(texel, [&] { return colour_of(texel, eye); });
            }
            Vec3f::Map(&rgb[3 * i]) = colour;
        }
    };
    return {shade, space};
}

}  // namespace radiafit::fits

#include "eval/texel_pixels.h"

namespace radiafit {

std::vector<RasterPixel> texel_pixels(const Atlas& atlas) {
    const auto* triangles = dynamic_cast<const TriangleAtlas*>(&atlas);
    std::vector<RasterPixel> pixels(atlas.texel_count());
    for (uint32_t t = 0; t < atlas.texel_count(); ++t) {
        if (!atlas.usable(t)) continue;
        if (!triangles) {
            pixels[t].triangle = t;
            continue;
        }
        const uint32_t triangle = t / atlas.texels_per_tile();
        const auto& b = triangles->tile(triangle).barycentric(t % atlas.texels_per_tile());
        pixels[t] = {triangle, b[1], b[2]};
    }
    return pixels;
}

}  // namespace radiafit

#include "samples/raster_distributor.h"

#include <algorithm>

namespace radiafit {

void RasterDistributor::distribute(const Camera& camera, const TargetImage& image, Distribution& out) {
    const uint32_t texels = atlas_->texels_per_tile();
    rasterizer_.draw(atlas_->mesh(), camera);

    // The item buffer; pixels outside the mask hold no item.
    const std::vector<RasterPixel>& pixels = rasterizer_.pixels();
    items_.assign(pixels.size(), no_texel);
    tile_visible_.assign(atlas_->tile_count(), 0);
    out.covered_pixels = 0;
    for (size_t k = 0; k < pixels.size(); ++k) {
        const RasterPixel& p = pixels[k];
        if (p.triangle == no_triangle || !image.masked_in(k)) continue;
        items_[k] = p.triangle * texels + atlas_->local_at(p.b1, p.b2);
        tile_visible_[p.triangle] = 1;
        ++out.covered_pixels;
    }

    out.texel_pixel.assign(atlas_->texel_count(), no_pixel);
    out.kept_pixels = 0;
    for (uint32_t tile = 0; tile < atlas_->tile_count(); ++tile) {
        if (!tile_visible_[tile]) continue;
        for (uint32_t local = 0; local < texels; ++local) {
            const Vec3d p = camera.project(atlas_->position(tile, local).cast<double>());
            // A visible tile lies in front of the camera. Not below zero, so truncation is floor.
            if (!(p.x() >= 0 && p.x() < camera.width && p.y() >= 0 && p.y() < camera.height)) continue;
            const uint32_t pixel =
                static_cast<uint32_t>(p.y()) * static_cast<uint32_t>(camera.width) + static_cast<uint32_t>(p.x());
            const uint32_t texel = tile * texels + local;
            if (items_[pixel] != texel) continue;
            out.texel_pixel[texel] = pixel;
            ++out.kept_pixels;
        }
    }
}

}  // namespace radiafit

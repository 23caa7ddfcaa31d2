#include "reference/tile_views.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "geometry/mesh_part.h"
#include "geometry/raster.h"

namespace radiafit::fits {
namespace {

/// One image's triangles, in ascending tile order.
struct ImageTiles {
    std::vector<uint32_t> tiles;
    std::vector<TileViews::Texel> texels;
};

class ImageResampler {
public:
    ImageResampler(const TriangleAtlas& atlas, ImageStream stream) : atlas_(&atlas), stream_(std::move(stream)) {}

    ImageTiles resample(const Camera& camera, uint32_t view) {
        stream_.load(view, image_);
        rasterizer_.draw(visible_mesh(atlas_->mesh()), camera);
        std::vector<uint8_t> visible(atlas_->tile_count(), 0);
        for (const RasterPixel& p : rasterizer_.pixels())
            if (const uint32_t t = fitted_triangle(atlas_->mesh(), p.triangle); t != no_triangle) visible[t] = 1;
        ImageTiles out;
        std::vector<TileViews::Texel> row;
        for (uint32_t tile = 0; tile < atlas_->tile_count(); ++tile) {
            if (!visible[tile]) continue;
            bool any = false;
            row.resize(atlas_->tile(tile).texels());
            for (uint32_t local = 0; local < row.size(); ++local) {
                row[local] = look_up(camera, tile, atlas_->position(tile, local));
                any = any || row[local].seen;
            }
            if (!any) continue;
            out.tiles.push_back(tile);
            out.texels.insert(out.texels.end(), row.begin(), row.end());
        }
        return out;
    }

private:
    /// Does a pixel show the surface around this tile? Across an edge colours go on, across a silhouette they don't.
    bool shows(int x, int y, uint32_t tile) const {
        if (x < 0 || y < 0 || x >= image_.width || y >= image_.height) return false;
        const size_t pixel = size_t(y) * image_.width + x;
        const uint32_t triangle = rasterizer_.pixels()[pixel].triangle;
        if (triangle == no_triangle || !image_.masked_in(pixel)) return false;
        const auto& triangles = visible_mesh(atlas_->mesh()).triangles;
        const uint32_t own = visible_triangle(atlas_->mesh(), tile);
        if (triangle == own) return true;
        for (uint32_t a : triangles[triangle])
            for (uint32_t b : triangles[own])
                if (a == b) return true;
        return false;
    }

    TileViews::Texel look_up(const Camera& camera, uint32_t tile, const Vec3f& position) const {
        const Vec3d pixel = camera.project(position.cast<double>());
        const double x = pixel.x(), y = pixel.y();
        if (!(x >= 0 && y >= 0 && x < image_.width && y < image_.height) || !shows(int(x), int(y), tile)) return {};
        const int x0 = int(std::floor(x - 0.5)), y0 = int(std::floor(y - 0.5));
        double sum[3] = {}, weights = 0;
        for (int j = 0; j < 2; ++j)
            for (int i = 0; i < 2; ++i) {
                const double weight = (1 - std::abs(x0 + i + 0.5 - x)) * (1 - std::abs(y0 + j + 0.5 - y));
                if (weight <= 0 || !shows(x0 + i, y0 + j, tile)) continue;
                const auto rgba = image_.channel16(size_t(y0 + j) * image_.width + size_t(x0 + i));
                for (int c = 0; c < 3; ++c) sum[c] += weight * rgba[size_t(c)];
                weights += weight;
            }
        TileViews::Texel texel{{}, 1};
        for (int c = 0; c < 3; ++c) texel.rgb[c] = uint16_t(std::lround(sum[c] / weights));
        return texel;
    }

    const TriangleAtlas* atlas_;
    ImageStream stream_;
    TargetImage image_;
    Rasterizer rasterizer_;
};

}  // namespace

TileViews resample_tiles(const Dataset& dataset, const TriangleAtlas& atlas, const std::vector<uint32_t>& views,
                         TargetSpace space) {
    TileViews out;
    out.views = views;
    ImageStream stream(dataset, StreamSource::disk, space);
    out.scale = stream.bits() == 8 ? stream.scale() / 257.0f : stream.scale();
    std::vector<ImageResampler> workers;
    for (int i = 0; i < thread_count(); ++i) workers.emplace_back(atlas, stream.another());
    std::vector<ImageTiles> images(views.size());
    parallel_for(views.size(), 1, [&](size_t i, int worker) {
        images[i] = workers[size_t(worker)].resample(dataset.views[views[i]].camera, views[i]);
    });

    // Counting sort by tile, stable in the image.
    out.tile_first.assign(atlas.tile_count() + 1, 0);
    for (const ImageTiles& image : images)
        for (uint32_t tile : image.tiles) ++out.tile_first[tile + 1];
    for (size_t tile = 0; tile < atlas.tile_count(); ++tile) out.tile_first[tile + 1] += out.tile_first[tile];
    std::vector<uint32_t> next(out.tile_first.begin(), out.tile_first.end() - 1);
    out.images.resize(out.tile_first.back());
    out.texel_first.assign(1, 0);
    for (uint32_t tile = 0; tile < atlas.tile_count(); ++tile)
        out.texel_first.push_back(out.texel_first.back() + out.images_of(tile).size() * atlas.tile(tile).texels());
    out.texels.resize(out.texel_first.back());
    for (size_t i = 0; i < images.size(); ++i) {
        ImageTiles image = std::move(images[i]);  // freed once its rows are placed
        auto from = image.texels.cbegin();
        for (const uint32_t tile : image.tiles) {
            const uint32_t place = next[tile]++;
            out.images[place] = uint32_t(i);
            const size_t texels = atlas.tile(tile).texels();
            const size_t to = out.texel_first[tile] + (place - out.tile_first[tile]) * texels;
            std::copy_n(from, texels, out.texels.begin() + ptrdiff_t(to));
            from += ptrdiff_t(texels);
        }
    }
    return out;
}

}  // namespace radiafit::fits

#include "eval/pixel_areas.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "base/error.h"
#include "base/parallel.h"
#include "dataset/truth.h"

namespace radiafit {
namespace {

constexpr int most_points = 9;  // 81 in all: their numbers fit bytes
constexpr int widest = 8192;    // that Rasterizer draws exactly

}  // namespace

void check_pixel_points(int n) {
    if (n < 1 || n > most_points || n % 2 == 0)
        throw UserError(fmt::format("pixel points {}: choose an odd number from 1 to {}", n, most_points));
}

PixelAreas::PixelAreas(const Dataset& dataset, int points) : dataset_(&dataset), points_(points) {
    if (points != as_photographed) check_pixel_points(points);
    if (points == as_photographed) points_ = has_truth(dataset) ? 1 : area_points;
    if (dataset.has_grid()) points_ = 1;
}

void PixelAreas::shade(const Contestant& contestant, const View& view, int worker) {
    centres_ = seen_pixels(*dataset_, view, rasterizer_);
    if (points_ > 1) return shade_areas(contestant, view);
    contestant.shade(view, centres_, rgb_, worker);
    if (rgb_.size() != 3 * centres_.size()) throw std::invalid_argument("a contestant left pixels out");
    seen_.resize(centres_.size());
    for (size_t i = 0; i < seen_.size(); ++i) seen_[i] = centres_[i].triangle != no_triangle;
}

struct PixelAreas::Tile {
    int x, y, width, height;  ///< pixels
};

void PixelAreas::shade_areas(const Contestant& contestant, const View& view) {
    const Camera& camera = view.camera;
    rgb_.assign(3 * centres_.size(), 0.0f);
    seen_.assign(centres_.size(), 0);
    shots_.resize(size_t(thread_count()));
    // as many points as the picture has pixels, so that none is larger than it, and no wider than is drawn exactly
    const int columns = (camera.width * points_ + widest - 1) / widest;
    const int width = (camera.width + columns - 1) / columns;
    const int height = std::max(1, camera.height * columns / (points_ * points_));
    std::vector<Tile> tiles;
    for (int y = 0; y < camera.height; y += height)
        for (int x = 0; x < camera.width; x += width)
            tiles.push_back({x, y, std::min(width, camera.width - x), std::min(height, camera.height - y)});
    parallel_for(tiles.size(), 1, [&](size_t i, int worker) { shade_tile(contestant, view, tiles[i], worker); });
}

void PixelAreas::shade_tile(const Contestant& contestant, const View& view, const Tile& tile, int worker) {
    const bool curved = contestant.space == TargetSpace::stored && dataset_->encoding == Encoding::u8_srgb;
    auto& [rasterizer, rgb] = shots_.at(size_t(worker));
    Camera camera = view.camera.cropped(tile.x, tile.y, tile.width, tile.height);
    camera.width *= points_, camera.height *= points_;
    for (double* length : {&camera.fx, &camera.fy, &camera.cx, &camera.cy}) *length *= points_;
    rasterizer.draw(dataset_->mesh, camera);
    const std::vector<RasterPixel>& points = rasterizer.pixels();
    contestant.shade(view, points, rgb, worker);
    if (rgb.size() != 3 * points.size()) throw std::invalid_argument("a contestant left points out");
    for (int y = 0; y < tile.height; ++y)
        for (int x = 0; x < tile.width; ++x) {
            const size_t pixel = size_t(tile.y + y) * size_t(view.camera.width) + size_t(tile.x + x);
            float* sum = &rgb_[3 * pixel];
            for (int k = 0; k < points_ * points_; ++k) {
                const size_t point =
                    size_t(y * points_ + k / points_) * size_t(camera.width) + size_t(x * points_ + k % points_);
                if (points[point].triangle == no_triangle) continue;
                ++seen_[pixel];
                for (size_t c = 0; c < 3; ++c) sum[c] += curved ? srgb_decode(rgb[3 * point + c]) : rgb[3 * point + c];
            }
            for (size_t c = 0; c < 3 && seen_[pixel] > 0; ++c) {
                sum[c] /= float(seen_[pixel]);
                if (curved) sum[c] = srgb_encode(sum[c]);
            }
        }
}

float PixelAreas::coverage(size_t pixel) const { return float(seen_[pixel]) / float(points_ * points_); }

std::vector<RasterPixel> seen_pixels(const Dataset& dataset, const View& view, Rasterizer& rasterizer) {
    if (!dataset.has_grid()) {
        rasterizer.draw(dataset.mesh, view.camera);
        return rasterizer.pixels();
    }
    std::vector<RasterPixel> out(dataset.grid.texel_count());
    const std::vector<Vec3f>& normals = dataset.grid.texel_normals;
    for (uint32_t t = 0; t < out.size(); ++t)
        if (normals.empty() || normals[t] != Vec3f::Zero()) out[t].triangle = t;
    return out;
}

}  // namespace radiafit

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
    if (points_ > 1) return shade_points(contestant, view);
    contestant.shade(view, centres_, rgb_, worker);
    if (rgb_.size() != 3 * centres_.size()) throw std::invalid_argument("a contestant left pixels out");
    seen_.resize(centres_.size());
    for (size_t i = 0; i < seen_.size(); ++i) seen_[i] = centres_[i].triangle != no_triangle;
}

void PixelAreas::shade_points(const Contestant& contestant, const View& view) {
    const bool curved = contestant.space == TargetSpace::stored && dataset_->encoding == Encoding::u8_srgb;
    const size_t pixels = centres_.size();
    rgb_.assign(3 * pixels, 0.0f);
    seen_.assign(pixels, 0);
    const auto each_side = size_t(points_), all = each_side * each_side;
    shots_.resize(std::min(all, size_t(threads_here())));
    for (size_t first = 0; first < all; first += shots_.size()) {
        const size_t count = std::min(shots_.size(), all - first);
        parallel_for(count, 1, [&](size_t i, int worker) {
            View moved = view;
            moved.camera.cx -= (double((first + i) % each_side) + 0.5) / points_ - 0.5;
            moved.camera.cy -= (double((first + i) / each_side) + 0.5) / points_ - 0.5;
            shots_[i].seen = seen_pixels(*dataset_, moved, shots_[i].rasterizer);
            contestant.shade(moved, shots_[i].seen, shots_[i].rgb, worker);
        });
        for (size_t s = 0; s < count; ++s) {  // sums in the order of the points
            const auto& [rasterizer, points, at_point] = shots_[s];
            if (at_point.size() != 3 * pixels) throw std::invalid_argument("a contestant left pixels out");
            for (size_t i = 0; i < pixels; ++i) {
                if (points[i].triangle == no_triangle) continue;
                ++seen_[i];
                for (size_t c = 3 * i; c < 3 * i + 3; ++c) rgb_[c] += curved ? srgb_decode(at_point[c]) : at_point[c];
            }
        }
    }
    for (size_t i = 0; i < pixels; ++i)
        for (size_t c = 3 * i; c < 3 * i + 3 && seen_[i] > 0; ++c) {
            rgb_[c] /= float(seen_[i]);
            if (curved) rgb_[c] = srgb_encode(rgb_[c]);
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

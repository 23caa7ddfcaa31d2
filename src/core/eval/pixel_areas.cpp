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

constexpr int most_points = 9;             // 81 in all: their numbers fit bytes
constexpr size_t most_gathered = 1 << 22;  // points of a thread, about, that a contestant is asked for at once

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
    gathered_.resize(std::min(all, size_t(threads_here())));
    for (size_t first = 0; first < all; first += gathered_.size()) {
        const size_t count = std::min(gathered_.size(), all - first);
        const size_t before = shots_.size();
        shots_.resize(before + count);
        parallel_for(count, 1, [&](size_t i, int) {
            View moved = view;
            moved.camera.cx -= (double((first + i) % each_side) + 0.5) / points_ - 0.5;
            moved.camera.cy -= (double((first + i) / each_side) + 0.5) / points_ - 0.5;
            Points& points = gathered_[i];
            const size_t begin = points.seen.size();
            const std::vector<RasterPixel> seen = seen_pixels(*dataset_, moved, points.rasterizer);
            for (uint32_t p = 0; p < seen.size(); ++p) {
                if (seen[p].triangle == no_triangle) continue;
                points.seen.push_back(seen[p]);
                points.pixels.push_back(p);
            }
            shots_[before + i] = {i, begin, points.seen.size()};
        });
        if (first + count == all || gathered_[0].seen.size() >= most_gathered) shade_gathered(contestant, view, curved);
    }
    for (size_t i = 0; i < pixels; ++i)
        for (size_t c = 3 * i; c < 3 * i + 3 && seen_[i] > 0; ++c) {
            rgb_[c] /= float(seen_[i]);
            if (curved) rgb_[c] = srgb_encode(rgb_[c]);
        }
}

void PixelAreas::shade_gathered(const Contestant& contestant, const View& view, bool curved) {
    parallel_for(gathered_.size(), 1, [&](size_t i, int worker) {
        contestant.shade(view, gathered_[i].seen, gathered_[i].rgb, worker);
        if (gathered_[i].rgb.size() != 3 * gathered_[i].seen.size())
            throw std::invalid_argument("a contestant left pixels out");
    });
    for (const auto& [by, begin, end] : shots_)  // sums in the order of the points
        for (size_t k = begin; k < end; ++k) {
            const size_t pixel = gathered_[by].pixels[k];
            ++seen_[pixel];
            for (size_t c = 0; c < 3; ++c) {
                const float value = gathered_[by].rgb[3 * k + c];
                rgb_[3 * pixel + c] += curved ? srgb_decode(value) : value;
            }
        }
    shots_.clear();
    for (Points& points : gathered_) points.seen.clear(), points.pixels.clear();
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

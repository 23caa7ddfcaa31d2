#include "exchange/padded_tiles.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"

namespace radiafit::tools {
namespace {

constexpr size_t largest_texture = 16384;  // that WebGL 2 and OpenGL show nearly everywhere

/// The nearest point of the triangle, to a change of its shape.
std::array<float, 2> inside(float b1, float b2) {
    b1 = std::max(b1, 0.0f);
    b2 = std::max(b2, 0.0f);
    const float beyond = std::max(0.0f, b1 + b2 - 1) / 2;
    b1 = std::clamp(b1 - beyond, 0.0f, 1.0f);
    return {b1, std::clamp(b2 - beyond, 0.0f, 1 - b1)};
}

}  // namespace

PaddedTiles::PaddedTiles(const TriangleAtlas& atlas) : atlas_(&atlas), side_(atlas.side()) {
    const size_t rectangles = (size_t(atlas.tile_count()) + 1) / 2;
    per_row_ = std::max(1, int(std::ceil(std::sqrt(double(rectangles) * (side_ + 4) / (side_ + 3)))));
    const size_t rows = (rectangles + size_t(per_row_) - 1) / size_t(per_row_);
    const size_t width = size_t(per_row_) * size_t(side_ + 3), height = rows * size_t(side_ + 4);
    if (width > largest_texture || height > largest_texture)
        throw UserError(fmt::format(
            "{} triangles of surface side {} need a texture of {} x {} texels, but {} is the most; fit with "
            "a smaller surface side or a coarser mesh",
            atlas.tile_count(), side_, width, height, largest_texture));
    width_ = int(width);
    height_ = int(height);
}

std::array<int, 2> PaddedTiles::rectangle(uint32_t triangle) const {
    const int number = int(triangle / 2);
    return {number % per_row_ * (side_ + 3), number / per_row_ * (side_ + 4)};
}

std::array<std::array<float, 2>, 3> PaddedTiles::corners(uint32_t triangle) const {
    const auto [x, y] = rectangle(triangle);
    const float n = float(side_), left = float(x), top = float(y);
    if (triangle % 2 == 0) return {{{left + 1, top + 1}, {left + n + 1, top + 1}, {left + 1, top + n + 1}}};
    const float right = left + n + 3, bottom = top + n + 4;
    return {{{right - 1, bottom - 1}, {right - n - 1, bottom - 1}, {right - 1, bottom - n - 1}}};
}

TextureImage PaddedTiles::bake(std::span<const float> values, int channels, SurfaceLookup lookup) const {
    const TexelLookup look_up(*atlas_, lookup);
    TextureImage out{width_, height_, channels, {}};
    out.values.assign(size_t(width_) * size_t(height_) * size_t(channels), 0.0f);
    parallel_for(atlas_->tile_count(), 64, [&](size_t t, int) {
        const auto triangle = uint32_t(t);
        if (atlas_->degenerate(triangle)) return;
        const auto [x0, y0] = rectangle(triangle);
        for (int j = 0; j <= side_ + 2; ++j)
            for (int i = 0; i + j <= side_ + 2; ++i) {
                const auto [b1, b2] = inside((float(i) - 0.5f) / float(side_), (float(j) - 0.5f) / float(side_));
                const bool upright = triangle % 2 == 0;
                const int x = upright ? x0 + i : x0 + side_ + 2 - i, y = upright ? y0 + j : y0 + side_ + 3 - j;
                float* place = &out.values[(size_t(y) * size_t(width_) + size_t(x)) * size_t(channels)];
                for (const auto& entry : look_up.at(triangle, b1, b2).entries()) {
                    const size_t texel = size_t(entry.triangle) * atlas_->texels_per_tile() + entry.local;
                    for (int c = 0; c < channels; ++c)
                        place[c] += entry.weight * values[texel * size_t(channels) + size_t(c)];
                }
            }
    });
    return out;
}

std::array<std::array<float, 2>, 3> atlas_corners(const TriangleAtlas& atlas, uint32_t triangle) {
    const int largest = atlas.side(), number = int(triangle / 2), per_row = atlas.rectangles_per_row();
    const float n = float(atlas.side(triangle));
    const float left = float(number % per_row * largest), top = float(number / per_row * (largest + 1));
    if (triangle % 2 == 0) return {{{left, top}, {left + n, top}, {left, top + n}}};
    const float right = left + float(largest), bottom = top + float(largest) + 1;
    return {{{right, bottom}, {right - n, bottom}, {right, bottom - n}}};
}

TextureImage in_layout(const Atlas& atlas, std::span<const float> values, int channels) {
    TextureImage out{atlas.width(), atlas.height(), channels, {}};
    out.values.assign(size_t(out.width) * size_t(out.height) * size_t(channels), 0.0f);
    for (uint32_t t = 0; t < atlas.texel_count(); ++t) {
        if (!atlas.usable(t)) continue;
        const auto [x, y] = atlas.place(t);
        std::copy_n(&values[size_t(t) * size_t(channels)], channels,
                    &out.values[(size_t(y) * size_t(out.width) + size_t(x)) * size_t(channels)]);
    }
    return out;
}

}  // namespace radiafit::tools

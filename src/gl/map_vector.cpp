#include "gl/map_vector.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/half.h"

namespace radiafit {

std::string to_string(Storage storage) {
    return storage == Storage::fp32 ? "fp32" : storage == Storage::fp16 ? "fp16" : "fp16-truncate";
}

ProblemGrid::ProblemGrid(size_t vertices, int side) : view_side(side) {
    columns = std::max(1, static_cast<int>(std::ceil(std::sqrt(double(vertices)))));
    rows = std::max(1, static_cast<int>((vertices + columns - 1) / columns));
}

Defines MapShape::defines(Storage storage) const {
    return {{"TERMS", std::to_string(terms())},
            {"VIEW_SIDE", std::to_string(grid.view_side)},
            {"COLUMNS", std::to_string(grid.columns)},
            {"SIDE", std::to_string(atlas->side())},
            {"RECTANGLES", std::to_string(atlas->rectangles_per_row())},
            {"STORAGE", std::to_string(int(storage))}};
}

MapVector::MapVector(const MapShape& shape, Storage storage) : storage_(storage), terms_(shape.terms()) {
    const GLenum format = storage == Storage::fp32 ? GL_RGBA32F : storage == Storage::fp16 ? GL_RG32UI : GL_RGBA16F;
    surface_ = Texture(format, shape.atlas->width(), shape.atlas->height(), shape.surface_layers());
    view_ = Texture(format, shape.grid.columns * shape.grid.view_side, shape.grid.rows * shape.grid.view_side, terms_);
}

namespace {

// One texel of four channels, as the texture's storage holds it: 16 bytes of floats or 8 of halves.
class Layer {
public:
    Layer(const Texture& texture, Storage storage)
        : texture_(&texture),
          storage_(storage),
          bytes_(storage == Storage::fp32 ? 16 : 8),
          data_(size_t(texture.width()) * texture.height() * bytes_) {}
    void put(int x, int y, const float* rgb) {
        uint8_t* at = data_.data() + (size_t(y) * texture_->width() + x) * bytes_;
        if (storage_ == Storage::fp32) {
            std::memcpy(at, rgb, 12);
            return;
        }
        for (int c = 0; c < 3; ++c) {
            const uint16_t half =
                storage_ == Storage::fp16 ? half_from_float(rgb[c]) : half_from_float_truncated(rgb[c]);
            std::memcpy(at + 2 * c, &half, 2);
        }
    }
    void get(int x, int y, float* rgb) const {
        const uint8_t* at = data_.data() + (size_t(y) * texture_->width() + x) * bytes_;
        if (storage_ == Storage::fp32) {
            std::memcpy(rgb, at, 12);
        } else {
            for (int c = 0; c < 3; ++c) {
                uint16_t half;
                std::memcpy(&half, at + 2 * c, 2);
                rgb[c] = float_from_half(half);
            }
        }
        rgb[3] = 0;
    }
    // RG32UI holds two packed pairs of halves, which on a little-endian machine is four halves in a row.
    GLenum format() const { return storage_ == Storage::fp16 ? GL_RG_INTEGER : GL_RGBA; }
    GLenum type() const {
        return storage_ == Storage::fp32 ? GL_FLOAT : storage_ == Storage::fp16 ? GL_UNSIGNED_INT : GL_HALF_FLOAT;
    }
    std::vector<uint8_t>& data() { return data_; }

private:
    const Texture* texture_;
    Storage storage_;
    size_t bytes_;
    std::vector<uint8_t> data_;
};

// Calls visit(x, y, offset) for every texel of one layer: offset into Parameters order.
template <class Visit>
void visit_surface(const MapShape& shape, int corner, int term, const Visit& visit) {
    const TriangleAtlas& atlas = *shape.atlas;
    for (uint32_t triangle = 0; triangle < atlas.tile_count(); ++triangle) {
        if (atlas.degenerate(triangle)) continue;
        const size_t map = shape.layout->map_offset(triangle, static_cast<uint32_t>(corner));
        for (uint32_t local = 0; local < atlas.texels_per_tile(); ++local) {
            const auto [x, y] = atlas.place(triangle * atlas.texels_per_tile() + local);
            visit(x, y, map + local * shape.layout->stride() + 4 * size_t(term));
        }
    }
}
template <class Visit>
void visit_view(const MapShape& shape, int term, const Visit& visit) {
    const int m = shape.grid.view_side;
    for (size_t v = 0; v < shape.layout->problem_count(); ++v) {
        const auto [column, row] = shape.grid.at(v);
        for (int texel = 0; texel < m * m; ++texel)
            visit(column * m + texel % m, row * m + texel / m,
                  shape.layout->view_offset(v) + size_t(texel) * shape.layout->stride() + 4 * size_t(term));
    }
}

}  // namespace

void MapVector::upload(const MapShape& shape, std::span<const float> values) {
    for (int layer = 0; layer < 3 * terms_; ++layer) {
        Layer data(surface_, storage_);
        visit_surface(shape, layer / terms_, layer % terms_,
                      [&](int x, int y, size_t at) { data.put(x, y, values.data() + at); });
        surface_.upload(data.format(), data.type(), data.data().data(), layer);
    }
    for (int term = 0; term < terms_; ++term) {
        Layer data(view_, storage_);
        visit_view(shape, term, [&](int x, int y, size_t at) { data.put(x, y, values.data() + at); });
        view_.upload(data.format(), data.type(), data.data().data(), term);
    }
}

void MapVector::download(const MapShape& shape, std::span<float> values) const {
    for (int layer = 0; layer < 3 * terms_; ++layer) {
        Layer data(surface_, storage_);
        surface_.download(data.format(), data.type(), data.data().data(), data.data().size(), layer);
        visit_surface(shape, layer / terms_, layer % terms_,
                      [&](int x, int y, size_t at) { data.get(x, y, values.data() + at); });
    }
    for (int term = 0; term < terms_; ++term) {
        Layer data(view_, storage_);
        view_.download(data.format(), data.type(), data.data().data(), data.data().size(), term);
        visit_view(shape, term, [&](int x, int y, size_t at) { data.get(x, y, values.data() + at); });
    }
}

}  // namespace radiafit

#include "fragment/map_vector.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "fragment/half_rounding.h"
#include "fragment/stored_layer.h"

namespace radiafit {

ProblemGrid::ProblemGrid(size_t vertices, int side) : view_side(side) {
    columns = std::max(1, static_cast<int>(std::ceil(std::sqrt(double(vertices)))));
    rows = std::max(1, static_cast<int>((vertices + columns - 1) / columns));
}

Defines loss_defines(const Loss& loss) {
    Defines all;
    if (loss.weighted()) all = {{"WEIGHTED", ""}};
    if (!loss.robust()) return all;
    const std::string name = loss_names[size_t(loss.kind)];
    return all + Defines{{"LOSS_VALUE_OF", name + "_value"},
                         {"LOSS_WEIGHT_OF", name + "_weight"},
                         {"LOSS_SCALE", fmt::format("{:.9e}", loss.scale)}};
}

Defines MapShape::defines(Storage storage) const {
    const Defines all{{"TERMS", std::to_string(terms())},
                      {"VIEW_SIDE", std::to_string(grid.view_side)},
                      {"COLUMNS", std::to_string(grid.columns)},
                      {"SIDE", std::to_string(atlas->side())},
                      {"RECTANGLES", std::to_string(atlas->rectangles_per_row())}};
    return all + storage_defines(storage) + loss_defines(loss);
}

MapVector::MapVector(const MapShape& shape, Storage storage) : shape_(&shape), storage_(storage) {
    const GLenum format = storage_format(storage);
    surface_ = Texture(format, shape.atlas->width(), shape.atlas->height(), shape.surface_layers());
    view_ = Texture(format, shape.grid.columns * shape.grid.view_side, shape.grid.rows * shape.grid.view_side,
                    shape.terms());
}

namespace {

// Calls visit(x, y, offset) for every texel of one layer: offset into Parameters order.
template <class Visit>
void visit_surface(const MapShape& shape, int corner, int term, const Visit& visit) {
    const TriangleAtlas& atlas = *shape.atlas;
    for (uint32_t triangle = 0; triangle < atlas.tile_count(); ++triangle) {
        if (atlas.degenerate(triangle)) continue;
        const size_t map = shape.layout->map_offset(triangle, static_cast<uint32_t>(corner));
        if (map == LfmLayout::no_map) continue;
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

void MapVector::upload(std::span<const float> values) {
    for (int layer = 0; layer < shape_->surface_layers(); ++layer) {
        StoredLayer data(surface_, storage_);
        visit_surface(*shape_, layer / shape_->terms(), layer % shape_->terms(),
                      [&](int x, int y, size_t at) { data.put(x, y, values.data() + at); });
        surface_.upload(data.format(), data.type(), data.data().data(), layer);
    }
    for (int term = 0; term < shape_->terms(); ++term) {
        StoredLayer data(view_, storage_);
        visit_view(*shape_, term, [&](int x, int y, size_t at) { data.put(x, y, values.data() + at); });
        view_.upload(data.format(), data.type(), data.data().data(), term);
    }
}

void MapVector::download(std::span<float> values) const {
    for (int layer = 0; layer < shape_->surface_layers(); ++layer) {
        StoredLayer data(surface_, storage_);
        surface_.download(data.format(), data.type(), data.data().data(), data.data().size(), layer);
        visit_surface(*shape_, layer / shape_->terms(), layer % shape_->terms(),
                      [&](int x, int y, size_t at) { data.get(x, y, values.data() + at); });
    }
    for (int term = 0; term < shape_->terms(); ++term) {
        StoredLayer data(view_, storage_);
        view_.download(data.format(), data.type(), data.data().data(), data.data().size(), term);
        visit_view(*shape_, term, [&](int x, int y, size_t at) { data.get(x, y, values.data() + at); });
    }
}

}  // namespace radiafit

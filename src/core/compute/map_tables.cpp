#include "compute/map_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "base/error.h"
#include "model/penalty.h"

namespace radiafit {
namespace {

/// Four neighbours of each texel, 16 bits each; 0xffff: none.
void append(std::vector<uint32_t>& words, const MapNeighbours& map) {
    for (size_t texel = 0; texel < map.texel_count(); ++texel) {
        uint32_t near[4] = {0xffff, 0xffff, 0xffff, 0xffff};
        std::ranges::copy(map.of(texel), near);
        words.push_back(near[0] | near[1] << 16);
        words.push_back(near[2] | near[3] << 16);
    }
}

}  // namespace

MapTables::MapTables(const TriangleAtlas& atlas, const VertexRings& rings, const LfmLayout& layout, float target_scale)
    : vertex_count_(int(rings.vertex_count())), tile_count_(int(atlas.tile_count())) {
    constexpr size_t most = 65535;  // of what is kept in 16 bits
    if (rings.max_valence() > most)
        throw UserError(
            fmt::format("a vertex of {} triangles has more than the {} that compute shaders count to here; choose "
                        "another engine",
                        rings.max_valence(), most));
    const auto push = [&](Table which, std::initializer_list<size_t> values) {
        for (const size_t value : values) table_[which].push_back(uint32_t(value));
    };
    // what is the same for all tiles of a side
    std::map<int, std::array<size_t, 2>> of_side;  // where neighbours, and the targets' weights, begin
    for (uint32_t t = 0; t < atlas.tile_count(); ++t) {
        const TriangleTile& tile = atlas.tile(t);
        if (!of_side.try_emplace(tile.side(), std::array{table_[neighbours].size(), weights_.size() / 4}).second)
            continue;
        append(table_[neighbours], MapNeighbours::triangle(tile.side()));
        for (uint32_t local = 0; local < tile.texels(); ++local) {
            for (const float weight : tile.barycentric(local)) weights_.push_back(weight * target_scale);
            weights_.push_back(0);
        }
    }
    view_neighbours_ = int(table_[neighbours].size());
    append(table_[neighbours], MapNeighbours::square(layout.view_side()));

    table_[tiles].resize(size_t(tile_words) * atlas.tile_count());
    for (uint32_t t = 0; t < atlas.tile_count(); ++t) {
        for (uint32_t corner = 0; corner < 3; ++corner) {
            of_tile(t, vertex + int(corner)) = atlas.mesh().triangles[t][corner];
            const size_t offset = layout.map_offset(t, corner);
            of_tile(t, map + int(corner)) = offset == LfmLayout::no_map ? 0 : uint32_t(offset / 4);
        }
        of_tile(t, texel_number) = atlas.degenerate(t) ? 0 : atlas.tile(t).texels();
        of_tile(t, target_weight) = uint32_t(of_side.at(atlas.side(t))[1]);
    }
    for (size_t v = 0; v < rings.vertex_count(); ++v) {
        const auto of_ring = rings.ring(v);
        const size_t first_map = table_[maps].size() / 3;
        push(vertices, {layout.offset(v) / 4, layout.view_offset(v) / 4, first_map, first_map + of_ring.size(), 0, 0,
                        table_[sites].size()});
        for (size_t position = 0; position < of_ring.size(); ++position) {
            const Corner& c = of_ring[position];
            push(maps, {layout.map_offset(c.triangle, c.corner) / 4, 3 * size_t(c.triangle) + c.corner,
                        of_side.at(atlas.side(c.triangle))[0]});
            for (uint32_t local = 0; local < atlas.tile(c.triangle).texels(); ++local)
                push(sites, {position << 16 | local});
        }
    }
}

void MapTables::upload() {
    std::vector<uint32_t> all;
    for (size_t t = 0; t < table_count; ++t) {
        begin_[t] = int(all.size());
        all.insert(all.end(), table_[t].begin(), table_[t].end());
        table_[t] = {};
    }
    on_device_ = FetchedBuffer("tables of the samples", GL_R32UI, all.size() * sizeof(uint32_t), all.data());
    target_weights_ = FetchedBuffer("weights", GL_RGBA32F, weights_.size() * sizeof(float), weights_.data());
    weights_ = {};
}

void MapTables::bind_to(const Program& program) const {
    program.bind_if_used("table", on_device_.texture);
    program.bind_if_used("target_weights", target_weights_.texture);
    program.set_if_used("tables", std::span<const int>(begin_));
    program.set_if_used("vertex_count", vertex_count_);
    program.set_if_used("tile_count", tile_count_);
    program.set_if_used("view_neighbours", view_neighbours_);
}

}  // namespace radiafit

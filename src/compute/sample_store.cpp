#include "compute/sample_store.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <numeric>

#include "base/error.h"
#include "gl/context.h"
#include "model/penalty.h"

namespace radiafit {
namespace {

bool is_of_8_bits(const Sample& s) {
    return std::ranges::all_of(s.rgb, [](uint16_t value) { return value % 257 == 0; });
}

/// Four neighbours of each texel, 16 bits each; 0xffff: none.
void append(std::vector<uint32_t>& words, const MapNeighbours& map) {
    for (size_t texel = 0; texel < map.texel_count(); ++texel) {
        uint32_t near[4] = {0xffff, 0xffff, 0xffff, 0xffff};
        std::ranges::copy(map.of(texel), near);
        words.push_back(near[0] | near[1] << 16);
        words.push_back(near[2] | near[3] << 16);
    }
}

/// A sample and the texel of its tile, or the group, that it stands under in the other order.
struct Placed {
    const Sample* sample;
    uint32_t place;
};

/// Work items of a tile, each with its samples, in blocks of `lanes`: rows of one sample of each item, filled up to the
/// first item's number.
class Columns {
public:
    Columns(uint32_t lanes, bool wide) : lanes_(lanes), wide_(wide) {}
    void add(const std::vector<std::vector<Placed>>& items, std::vector<uint32_t>& first_of_blocks) {
        for (size_t begin = 0; begin < items.size(); begin += lanes_) {
            const size_t width = std::min<size_t>(lanes_, items.size() - begin), rows = items[begin].size();
            const size_t first = words.size() / (wide_ ? 2 : 1);
            first_of_blocks.push_back(uint32_t(first));
            words.resize((first + rows * width) * (wide_ ? 2 : 1));
            for (size_t i = 0; i < width; ++i)
                for (size_t row = 0; row < items[begin + i].size(); ++row)
                    put(first + row * width + i, items[begin + i][row]);
        }
    }
    std::vector<uint32_t> words;

private:
    void put(size_t at, const Placed& placed) {
        const uint16_t* rgb = placed.sample->rgb;
        if (wide_) {
            words[2 * at] = uint32_t(rgb[0]) | uint32_t(rgb[1]) << 16;
            words[2 * at + 1] = uint32_t(rgb[2]) | placed.place << 16;
        } else {
            words[at] = rgb[0] / 257u | rgb[1] / 257u << 8 | rgb[2] / 257u << 16 | placed.place << 24;
        }
    }

    uint32_t lanes_;
    bool wide_;
};

/// Indices of items, those with most samples first.
template <class Size>
std::vector<uint32_t> by_size(size_t count, const Size& size) {
    std::vector<uint32_t> order(count);
    std::iota(order.begin(), order.end(), 0u);
    std::ranges::stable_sort(order, std::greater(), size);
    return order;
}

}  // namespace

SampleStore::SampleStore(const Dataset& dataset, const TriangleAtlas& atlas, const VertexRings& rings,
                         const LfmLayout& layout, const SampleList& samples, const LfmOptions& options, uint32_t lanes)
    : group_count_(samples.tile_groups.empty() ? 0 : samples.tile_groups.back()),
      vertex_count_(int(rings.vertex_count())),
      tile_count_(int(samples.tile_count())) {
    const size_t images = samples.image_count();
    const auto most_samples = uint64_t(Context::current().limits().texture_buffer_texels);
    if (samples.samples.size() > most_samples)
        throw UserError(fmt::format("{} samples are more than the {} that {} fetches from; choose another engine",
                                    samples.samples.size(), most_samples, Context::current().renderer()));
    constexpr size_t most = 65535;  // of what is kept in 16 bits
    if (images > most || rings.max_valence() > most)
        throw UserError(
            fmt::format("{} images, or a vertex of {} triangles, are more than the {} that compute shaders "
                        "count to here; choose another engine",
                        images, rings.max_valence(), most));
    const auto groups_of = [&](uint32_t tile) { return samples.tile_groups[tile + 1] - samples.tile_groups[tile]; };
    uint32_t most_groups = 0;
    for (uint32_t t = 0; t < samples.tile_count(); ++t) most_groups = std::max(most_groups, groups_of(t));
    wide_ = most_groups > 256 || atlas.texels_per_tile() > 256 || !std::ranges::all_of(samples.samples, is_of_8_bits);

    std::array<std::vector<uint32_t>, table_count> table;
    const auto push = [&](Table which, std::initializer_list<size_t> values) {
        for (const size_t value : values) table[which].push_back(uint32_t(value));
    };

    // what is the same for all tiles of a side
    std::map<int, std::array<size_t, 2>> of_side;  // where neighbours, and the targets' weights, begin
    std::vector<float> weights;
    for (uint32_t t = 0; t < samples.tile_count(); ++t) {
        const TriangleTile& tile = atlas.tile(t);
        if (!of_side.try_emplace(tile.side(), std::array{table[neighbours].size(), weights.size() / 4}).second)
            continue;
        append(table[neighbours], MapNeighbours::triangle(tile.side()));
        for (uint32_t local = 0; local < tile.texels(); ++local) {
            for (const float weight : tile.barycentric(local)) weights.push_back(weight * samples.scale);
            weights.push_back(0);
        }
    }
    view_neighbours_ = int(table[neighbours].size());
    append(table[neighbours], MapNeighbours::square(options.view_side));

    // tiles and their samples in both orders
    Columns by_group(lanes, wide_), by_texel(lanes, wide_);
    std::vector<std::array<uint32_t, 4>> groups(group_count_);  // samples; pairs of three vertices
    std::vector<uint32_t> image_of_group(group_count_);         // in the order of the device
    for (uint32_t t = 0; t < samples.tile_count(); ++t) {
        const bool usable = !atlas.degenerate(t);
        tile_samples_.push_back(
            uint32_t(samples.groups[samples.tile_groups[t + 1]].first - samples.groups[samples.tile_groups[t]].first));
        const size_t texel_count = usable ? atlas.tile(t).texels() : 0;
        const uint32_t first_group = samples.tile_groups[t];
        const auto [near, first_weight] = of_side.at(atlas.side(t));
        for (const uint32_t vertex : atlas.mesh().triangles[t]) push(tiles, {vertex});
        for (uint32_t corner = 0; corner < 3; ++corner) {
            const size_t map = layout.map_offset(t, corner);
            push(tiles, {map == LfmLayout::no_map ? 0 : map / 4});
        }
        push(tiles, {first_group, groups_of(t), table[texels].size(), texel_count, first_weight, table[blocks].size()});

        const std::vector<uint32_t> order =
            by_size(groups_of(t), [&](uint32_t g) { return samples.of_group(first_group + g).size(); });
        std::vector<std::vector<Placed>> of_group(order.size()), of_texel(texel_count);
        std::vector<uint32_t> rank(order.size());
        for (uint32_t i = 0; i < order.size(); ++i) {
            rank[order[i]] = i;
            const uint32_t group = first_group + order[i];
            image_of_group[first_group + i] = samples.groups[group].image;
            groups[first_group + i][0] = uint32_t(samples.of_group(group).size());
            for (const Sample& s : samples.of_group(group)) of_group[i].push_back({&s, s.local});
        }
        for (uint32_t g = 0; g < order.size(); ++g)  // in the images' order
            for (const Sample& s : samples.of_group(first_group + g)) of_texel[s.local].push_back({&s, rank[g]});
        by_group.add(of_group, table[blocks]);
        push(tiles, {table[blocks].size()});
        const std::vector<uint32_t> texel_order = by_size(texel_count, [&](uint32_t l) { return of_texel[l].size(); });
        std::vector<std::vector<Placed>> sorted;
        for (const uint32_t local : texel_order) {
            push(texels, {of_texel[local].size() << 16 | local});
            sorted.push_back(std::move(of_texel[local]));
        }
        by_texel.add(sorted, table[blocks]);
    }

    // vertices, their maps, and who sees them
    const auto frames = vertex_frames(atlas.mesh());
    std::vector<Vec3d> centers;
    for (const uint32_t view : samples.views) centers.push_back(dataset.views[view].camera.center());
    std::vector<uint32_t> pairs;
    std::vector<std::vector<uint32_t>> seen(images);  // of one vertex: 3 x group + corner, by image
    for (size_t v = 0; v < rings.vertex_count(); ++v) {
        const auto ring = rings.ring(v);
        const size_t first_map = table[maps].size() / 3, first_pair = pair_count_;
        for (auto& of_image : seen) of_image.clear();
        for (const Corner& c : ring)
            for (uint32_t g = samples.tile_groups[c.triangle]; g < samples.tile_groups[c.triangle + 1]; ++g)
                seen[image_of_group[g]].push_back(3 * g + c.corner);
        std::vector<std::vector<uint32_t>> cells(size_t(layout.view_texels()));
        for (uint32_t image = 0; image < images; ++image) {
            if (seen[image].empty()) continue;
            const Vec3f& position = atlas.mesh().positions[v];
            const ViewFootprint f =
                view_footprint(frames[v], position, centers[image], options.view_side, options.lookup);
            const auto root = float(std::sqrt(view_weight(frames[v], position, centers[image], options.loss.weights)));
            for (const float weight : f.weight) pairs.push_back(std::bit_cast<uint32_t>(weight * root));
            pairs.insert(pairs.end(), {uint32_t(f.texel), std::bit_cast<uint32_t>(root), 0u, 0u});
            cells[f.texel].push_back(uint32_t(pair_count_ - first_pair));
            push(pair_first, {table[pair_groups].size()});
            for (const uint32_t entry : seen[image]) {
                push(pair_groups, {entry});
                groups[entry / 3][1 + entry % 3] = uint32_t(pair_count_);
            }
            ++pair_count_;
        }
        push(vertices, {layout.offset(v) / 4, layout.view_offset(v) / 4, first_map, first_map + ring.size(), first_pair,
                        pair_count_, table[sites].size()});
        for (const auto& cell : cells) {
            push(cell_first, {table[cell_pairs].size()});
            table[cell_pairs].insert(table[cell_pairs].end(), cell.begin(), cell.end());
        }
        push(cell_first, {table[cell_pairs].size()});
        for (size_t position = 0; position < ring.size(); ++position) {
            const Corner& c = ring[position];
            push(maps, {layout.map_offset(c.triangle, c.corner) / 4, 3 * size_t(c.triangle) + c.corner,
                        of_side.at(atlas.side(c.triangle))[0]});
            for (uint32_t local = 0; local < atlas.tile(c.triangle).texels(); ++local)
                push(sites, {position << 16 | local});
        }
    }
    push(pair_first, {table[pair_groups].size()});

    std::vector<uint32_t> all;
    for (size_t t = 0; t < table_count; ++t) {
        table_begin_[t] = int(all.size());
        all.insert(all.end(), table[t].begin(), table[t].end());
        table[t] = {};
    }
    const auto upload = [](const char* what, GLenum format, auto& values) {
        FetchedBuffer buffer(what, format, values.size() * sizeof values[0], values.data());
        values = {};
        return buffer;
    };
    const GLenum word = wide_ ? GL_RG32UI : GL_R32UI;
    tables_ = upload("tables of the samples", GL_R32UI, all);
    pairs_ = upload("cameras' views of vertices", GL_RGBA32UI, pairs);
    groups_ = upload("groups of samples", GL_RGBA32UI, groups);
    target_weights_ = upload("weights", GL_RGBA32F, weights);
    by_group_ = upload("samples", word, by_group.words);
    by_texel_ = upload("samples", word, by_texel.words);
}

void SampleStore::bind_to(const Program& program) const {
    program.bind_if_used("table", tables_.texture);
    program.bind_if_used("pairs", pairs_.texture);
    program.bind_if_used("groups", groups_.texture);
    program.bind_if_used("target_weights", target_weights_.texture);
    program.bind_if_used("samples_by_group", by_group_.texture);
    program.bind_if_used("samples_by_texel", by_texel_.texture);
    program.set_if_used("tables", std::span<const int>(table_begin_));
    program.set_if_used("vertex_count", vertex_count_);
    program.set_if_used("tile_count", tile_count_);
    program.set_if_used("view_neighbours", view_neighbours_);
}

}  // namespace radiafit

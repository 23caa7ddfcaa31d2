#include "compute/sample_store.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>

#include "base/error.h"
#include "gl/context.h"
#include "model/penalty.h"

namespace radiafit {
namespace {

constexpr uint32_t none = 0xffff;  // of 16 bits

/// Numbers of 16 bits, two to a word.
class Halves {
public:
    explicit Halves(size_t count) : words_((count + 1) / 2, none << 16 | none) {}
    void set(size_t i, uint32_t value) {
        const uint32_t shift = 16 * (i & 1);
        words_[i / 2] = (words_[i / 2] & ~(none << shift)) | value << shift;
    }
    uint32_t get(size_t i) const { return words_[i / 2] >> (16 * (i & 1)) & none; }
    const std::vector<uint32_t>& words() const { return words_; }

private:
    std::vector<uint32_t> words_;
};

/// A sample of four bytes or eight; `place` is a texel of the tile, or a group of it.
void append(std::vector<uint32_t>& words, bool wide, const Sample& s, uint32_t place) {
    if (wide) {
        words.push_back(uint32_t(s.rgb[0]) | uint32_t(s.rgb[1]) << 16);
        words.push_back(uint32_t(s.rgb[2]) | place << 16);
    } else {
        words.push_back(s.rgb[0] / 257u | s.rgb[1] / 257u << 8 | s.rgb[2] / 257u << 16 | place << 24);
    }
}

bool is_of_8_bits(const Sample& s) {
    return std::ranges::all_of(s.rgb, [](uint16_t value) { return value % 257 == 0; });
}

/// Four neighbours of each texel, 16 bits each.
void append(std::vector<uint32_t>& words, const MapNeighbours& map) {
    for (size_t texel = 0; texel < map.texel_count(); ++texel) {
        Halves near(4);
        const auto of = map.of(texel);
        for (size_t i = 0; i < of.size(); ++i) near.set(i, of[i]);
        words.insert(words.end(), near.words().begin(), near.words().end());
    }
}

}  // namespace

namespace {

void check_size(const char* what, uint64_t bytes, uint64_t most) {
    if (bytes > most)
        throw UserError(fmt::format("{} take {} MB, and {} allows {} MB; choose another engine, or a smaller fit", what,
                                    bytes / 1000000 + 1, Context::current().renderer(), most / 1000000));
}

uint64_t texel_bytes(GLenum format) {
    switch (format) {
        case GL_R32UI:
            return 4;
        case GL_RG32UI:
            return 8;
        default:
            return 16;
    }
}

}  // namespace

FetchedBuffer::FetchedBuffer(const char* what, GLenum format, size_t bytes, const void* data, bool dynamic) {
    check_size(what, bytes, uint64_t(Context::current().limits().texture_buffer_texels) * texel_bytes(format));
    buffer = Buffer(bytes, data, dynamic);
    texture = Texture::of_buffer(format, buffer);
}

Buffer storage_buffer(const char* what, size_t bytes) {
    check_size(what, bytes, uint64_t(Context::current().limits().ssbo_bytes));
    Buffer buffer(bytes, nullptr, true);
    buffer.clear();
    return buffer;
}

SampleStore::SampleStore(const Dataset& dataset, const TriangleAtlas& atlas, const VertexRings& rings,
                         const LfmLayout& layout, const SampleList& samples, const LfmOptions& options)
    : vertex_count_(int(rings.vertex_count())) {
    const size_t images = samples.image_count(), tiles = samples.tile_count();
    if (samples.samples.size() >= UINT32_MAX)
        throw UserError(fmt::format("{} samples are more than this engine counts to; choose another engine",
                                    samples.samples.size()));
    size_t most_groups = 0;
    for (size_t t = 0; t < tiles; ++t)
        most_groups = std::max<size_t>(most_groups, samples.tile_groups[t + 1] - samples.tile_groups[t]);
    wide_ = most_groups > 256 || atlas.texels_per_tile() > 256 || !std::ranges::all_of(samples.samples, is_of_8_bits);

    std::array<std::vector<uint32_t>, table_count> table;
    const auto push = [&](Table which, auto value) { table[which].push_back(uint32_t(value)); };

    // samples in both orders; which group of a tile is an image's
    std::vector<uint32_t> by_image, by_texel, tile_texel(tiles);
    Halves group_of_image(tiles * images);
    std::vector<std::vector<uint32_t>> of_texel;  // of one tile: samples and their groups
    for (uint32_t t = 0; t < tiles; ++t) {
        const size_t texels = atlas.tile(t).texels();
        of_texel.assign(texels, {});
        for (uint32_t g = samples.tile_groups[t]; g < samples.tile_groups[t + 1]; ++g) {
            const uint32_t in_tile = g - samples.tile_groups[t];
            group_of_image.set(t * images + samples.groups[g].image, in_tile);
            push(group_first, samples.groups[g].first);
            for (const Sample& s : samples.of_group(g)) {
                append(by_image, wide_, s, s.local);
                append(of_texel[s.local], wide_, s, in_tile);
            }
        }
        tile_texel[t] = uint32_t(table[texel_first].size());
        for (const auto& words : of_texel) {
            push(texel_first, by_texel.size() / (wide_ ? 2 : 1));
            by_texel.insert(by_texel.end(), words.begin(), words.end());
        }
    }
    push(group_first, samples.samples.size());
    push(texel_first, samples.samples.size());
    table[groups_of_images] = group_of_image.words();

    // what is the same for all tiles of a side
    std::map<int, std::array<uint32_t, 4>> of_side;  // neighbours, and the targets' weights of three corners
    for (uint32_t t = 0; t < tiles; ++t) {
        const TriangleTile& tile = atlas.tile(t);
        const auto [place, fresh] = of_side.try_emplace(tile.side());
        if (!fresh) continue;
        place->second[0] = uint32_t(table[neighbours].size());
        append(table[neighbours], MapNeighbours::triangle(tile.side()));
        for (size_t corner = 0; corner < 3; ++corner) {
            place->second[1 + corner] = uint32_t(table[target_weights].size());
            for (uint32_t local = 0; local < tile.texels(); ++local)
                push(target_weights, std::bit_cast<uint32_t>(tile.barycentric(local)[corner] * samples.scale));
        }
    }
    view_neighbours_ = int(table[neighbours].size());
    append(table[neighbours], MapNeighbours::square(options.view_side));

    // vertices, their maps, and who sees them
    const auto frames = vertex_frames(atlas.mesh());
    std::vector<Vec3d> centers;
    for (const uint32_t view : samples.views) centers.push_back(dataset.views[view].camera.center());
    std::vector<uint32_t> pairs;
    size_t groups_of_rings = 0;
    for (const Corner& c : rings.corners())
        groups_of_rings += samples.tile_groups[c.triangle + 1] - samples.tile_groups[c.triangle];
    Halves pair_of_group(groups_of_rings);
    size_t next_group = 0;
    const size_t view_texels = size_t(layout.view_texels());
    std::vector<uint32_t> pair_of_image(images);
    for (size_t v = 0; v < rings.vertex_count(); ++v) {
        const auto ring = rings.ring(v);
        const size_t first_map = table[maps].size() / 7;
        for (const size_t value : {layout.offset(v) / 4, layout.view_offset(v) / 4, first_map, first_map + ring.size()})
            push(vertices, value);

        std::ranges::fill(pair_of_image, none);
        const size_t first_pair = pair_count_;
        const auto groups_of = [&](const Corner& c) {
            return std::span(samples.groups)
                .subspan(samples.tile_groups[c.triangle],
                         samples.tile_groups[c.triangle + 1] - samples.tile_groups[c.triangle]);
        };
        for (const Corner& c : ring)
            for (const SampleGroup& group : groups_of(c)) pair_of_image[group.image] = 0;
        std::vector<std::vector<uint32_t>> cells(view_texels);
        uint32_t own = 0;
        for (uint32_t image = 0; image < images; ++image) {
            if (pair_of_image[image] == none) continue;
            const Vec3f& position = atlas.mesh().positions[v];
            const ViewFootprint f =
                view_footprint(frames[v], position, centers[image], options.view_side, options.lookup);
            const auto root = float(std::sqrt(view_weight(frames[v], position, centers[image], options.loss.weights)));
            for (const float weight : f.weight) pairs.push_back(std::bit_cast<uint32_t>(weight * root));
            for (const uint32_t word : {uint32_t(f.texel), image, std::bit_cast<uint32_t>(root), 0u})
                pairs.push_back(word);
            pair_of_image[image] = own;
            cells[f.texel].push_back(own++);
        }
        pair_count_ += own;
        for (const size_t value : {first_pair, pair_count_, table[sites].size()}) push(vertices, value);
        for (const auto& cell : cells) {
            push(cell_first, table[cell_pairs].size());
            table[cell_pairs].insert(table[cell_pairs].end(), cell.begin(), cell.end());
        }
        push(cell_first, table[cell_pairs].size());

        for (size_t position = 0; position < ring.size(); ++position) {
            const Corner& c = ring[position];
            const auto& side = of_side.at(atlas.side(c.triangle));
            for (const size_t value : {layout.map_offset(c.triangle, c.corner) / 4,
                                       size_t(samples.tile_groups[c.triangle]), size_t(tile_texel[c.triangle]),
                                       next_group, c.triangle * images, size_t(side[1 + c.corner]), size_t(side[0])})
                push(maps, value);
            for (const SampleGroup& group : groups_of(c)) pair_of_group.set(next_group++, pair_of_image[group.image]);
            for (uint32_t local = 0; local < atlas.tile(c.triangle).texels(); ++local)
                push(sites, position << 16 | local);
        }
    }
    table[pairs_of_groups] = pair_of_group.words();

    std::vector<uint32_t> all;
    for (size_t t = 0; t < table_count; ++t) {
        table_begin_[t] = int(all.size());
        all.insert(all.end(), table[t].begin(), table[t].end());
        table[t] = {};
    }
    const auto upload = [](const char* what, GLenum format, const std::vector<uint32_t>& values) {
        return FetchedBuffer(what, format, values.size() * sizeof values[0], values.data());
    };
    tables_ = upload("tables of the samples", GL_R32UI, all);
    pairs_ = upload("cameras' views of vertices", GL_RGBA32UI, pairs);
    by_image_ = upload("samples", wide_ ? GL_RG32UI : GL_R32UI, by_image);
    by_texel_ = upload("samples", wide_ ? GL_RG32UI : GL_R32UI, by_texel);
}

void SampleStore::bind_to(const Program& program) const {
    program.bind_if_used("table", tables_.texture);
    program.bind_if_used("pairs", pairs_.texture);
    program.bind_if_used("samples_by_image", by_image_.texture);
    program.bind_if_used("samples_by_texel", by_texel_.texture);
    program.set_if_used("tables", std::span<const int>(table_begin_));
    program.set_if_used("vertex_count", vertex_count_);
    program.set_if_used("view_neighbours", view_neighbours_);
}

}  // namespace radiafit

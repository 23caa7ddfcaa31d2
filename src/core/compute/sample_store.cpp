#include "compute/sample_store.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

#include "base/error.h"
#include "gl/context.h"
#include "model/penalty.h"

namespace radiafit {
namespace {

bool is_of_8_bits(const Sample& s) {
    return std::ranges::all_of(s.rgb, [](uint16_t value) { return value % 257 == 0; });
}

constexpr uint32_t no_pair = 0xffffffff;  // of a vertex without a ring, at the rim of a part

/// A sample, and its place in the other order: the texel of its tile, or its group.
struct Placed {
    const Sample* sample;
    uint32_t place;
};

std::array<uint32_t, 2> wide_words(const Placed& placed) {
    const uint16_t* rgb = placed.sample->rgb;
    return {uint32_t(rgb[0]) | uint32_t(rgb[1]) << 16, uint32_t(rgb[2]) | placed.place << 16};
}
uint32_t narrow_word(const Placed& placed) {
    const uint16_t* rgb = placed.sample->rgb;
    return rgb[0] / 257u | rgb[1] / 257u << 8 | rgb[2] / 257u << 16 | placed.place << 24;
}

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
        if (wide_)
            std::ranges::copy(wide_words(placed), &words[2 * at]);
        else
            words[at] = narrow_word(placed);
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

template <class Values>
FetchedBuffer upload(const char* what, GLenum format, const Values& values) {
    return FetchedBuffer(what, format, values.size() * sizeof values[0], values.data());
}

}  // namespace

SampleStore::SampleStore(const Dataset& dataset, const TriangleAtlas& atlas, const VertexRings& rings,
                         const SampleList& samples, const LfmOptions& options, Order order, uint32_t lanes,
                         MapTables& tables)
    : group_count_(samples.tile_groups.empty() ? 0 : samples.tile_groups.back()),
      sample_count_(samples.samples.size()) {
    check(atlas, samples, order);
    for (uint32_t t = 0; t < samples.tile_count(); ++t)
        tile_samples_.push_back(
            uint32_t(samples.groups[samples.tile_groups[t + 1]].first - samples.groups[samples.tile_groups[t]].first));
    Groups groups(group_count_);
    std::vector<uint32_t> image_of_group(group_count_);  // in the order of the device
    if (order == Order::gathered)
        place_by_group_and_texel(samples, lanes, tables, groups, image_of_group);
    else
        list(samples, groups, image_of_group);
    add_pairs(dataset, atlas, rings, samples, options, order, image_of_group, tables, groups);
    groups_ = upload("groups of samples", GL_RGBA32UI, groups);
    tables.upload();
}

void SampleStore::check(const TriangleAtlas& atlas, const SampleList& samples, Order order) {
    const auto most_samples = uint64_t(Context::current().limits().texture_buffer_texels);
    if (samples.samples.size() > most_samples)
        throw UserError(fmt::format("{} samples are more than the {} that {} fetches from; choose another engine",
                                    samples.samples.size(), most_samples, Context::current().renderer()));
    constexpr size_t most = 65535;  // of what is kept in 16 bits
    if (samples.image_count() > most)
        throw UserError(
            fmt::format("{} images are more than the {} that compute shaders count to here; choose another engine",
                        samples.image_count(), most));
    uint32_t most_groups = 0;
    for (uint32_t t = 0; t < samples.tile_count() && order == Order::gathered; ++t)
        most_groups = std::max(most_groups, samples.tile_groups[t + 1] - samples.tile_groups[t]);
    wide_ = most_groups > 256 || atlas.texels_per_tile() > 256 || !std::ranges::all_of(samples.samples, is_of_8_bits);
}

void SampleStore::place_by_group_and_texel(const SampleList& samples, uint32_t lanes, MapTables& tables, Groups& groups,
                                           std::vector<uint32_t>& image_of_group) {
    Columns by_group(lanes, wide_), by_texel(lanes, wide_);
    std::vector<uint32_t>&blocks = tables[MapTables::blocks], &texels = tables[MapTables::texels];
    for (uint32_t t = 0; t < samples.tile_count(); ++t) {
        const uint32_t first_group = samples.tile_groups[t], group_number = samples.tile_groups[t + 1] - first_group;
        const uint32_t texel_number = tables.of_tile(t, MapTables::texel_number);
        tables.of_tile(t, MapTables::group) = first_group;
        tables.of_tile(t, MapTables::group_number) = group_number;
        tables.of_tile(t, MapTables::texel) = uint32_t(texels.size());
        const std::vector<uint32_t> order =
            by_size(group_number, [&](uint32_t g) { return samples.of_group(first_group + g).size(); });
        std::vector<std::vector<Placed>> of_group(order.size()), of_texel(texel_number);
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
        tables.of_tile(t, MapTables::group_block) = uint32_t(blocks.size());
        by_group.add(of_group, blocks);
        tables.of_tile(t, MapTables::texel_block) = uint32_t(blocks.size());
        const std::vector<uint32_t> texel_order = by_size(texel_number, [&](uint32_t l) { return of_texel[l].size(); });
        std::vector<std::vector<Placed>> sorted;
        for (const uint32_t local : texel_order) {
            texels.push_back(uint32_t(of_texel[local].size() << 16 | local));
            sorted.push_back(std::move(of_texel[local]));
        }
        by_texel.add(sorted, blocks);
    }
    const GLenum word = wide_ ? GL_RG32UI : GL_R32UI;
    by_group_ = upload("samples", word, by_group.words);
    by_texel_ = upload("samples", word, by_texel.words);
}

void SampleStore::list(const SampleList& samples, Groups& groups, std::vector<uint32_t>& image_of_group) {
    std::vector<uint32_t> words, group_of_sample;
    for (uint32_t t = 0; t < samples.tile_count(); ++t)
        for (uint32_t g = samples.tile_groups[t]; g < samples.tile_groups[t + 1]; ++g) {
            groups[g] = {t, no_pair, no_pair, no_pair};
            image_of_group[g] = samples.groups[g].image;
            for (const Sample& s : samples.of_group(g)) {
                group_of_sample.push_back(g);
                const Placed placed{&s, s.local};
                if (wide_)
                    std::ranges::copy(wide_words(placed), std::back_inserter(words));
                else
                    words.push_back(narrow_word(placed));
            }
        }
    listed_ = upload("samples", wide_ ? GL_RG32UI : GL_R32UI, words);
    listed_groups_ = upload("samples' groups", GL_R32UI, group_of_sample);
}

// Who sees each vertex: pairs of a vertex and an image, those of a vertex one after another.
void SampleStore::add_pairs(const Dataset& dataset, const TriangleAtlas& atlas, const VertexRings& rings,
                            const SampleList& samples, const LfmOptions& options, Order order,
                            const std::vector<uint32_t>& image_of_group, MapTables& tables, Groups& groups) {
    const size_t images = samples.image_count();
    const auto frames = vertex_frames(atlas.mesh());
    std::vector<Vec3d> centers;
    for (const uint32_t view : samples.views) centers.push_back(dataset.views[view].camera.center());
    std::vector<uint32_t> pairs;
    std::vector<std::vector<uint32_t>> seen(images);  // of one vertex: 3 x group + corner, by image
    std::vector<uint32_t>&first = tables[MapTables::pair_first], &pair_groups = tables[MapTables::pair_groups];
    std::vector<uint32_t>&cell_first = tables[MapTables::cell_first], &cell_pairs = tables[MapTables::cell_pairs];
    for (size_t v = 0; v < rings.vertex_count(); ++v) {
        const size_t first_pair = pair_count_;
        for (auto& of_image : seen) of_image.clear();
        for (const Corner& c : rings.ring(v))
            for (uint32_t g = samples.tile_groups[c.triangle]; g < samples.tile_groups[c.triangle + 1]; ++g)
                seen[image_of_group[g]].push_back(3 * g + c.corner);
        std::vector<std::vector<uint32_t>> cells(size_t(options.view_side) * size_t(options.view_side));
        for (uint32_t image = 0; image < images; ++image) {
            if (seen[image].empty()) continue;
            const Vec3f& position = atlas.mesh().positions[v];
            const ViewFootprint f =
                view_footprint(frames[v], position, centers[image], options.view_side, options.lookup);
            const auto root = float(std::sqrt(view_weight(frames[v], position, centers[image], options.loss.weights)));
            for (const float weight : f.weight) pairs.push_back(std::bit_cast<uint32_t>(weight * root));
            pairs.insert(pairs.end(), {uint32_t(f.texel), std::bit_cast<uint32_t>(root), uint32_t(v), 0u});
            cells[f.texel].push_back(uint32_t(pair_count_ - first_pair));
            if (order == Order::gathered) {
                first.push_back(uint32_t(pair_groups.size()));
                pair_groups.insert(pair_groups.end(), seen[image].begin(), seen[image].end());
            }
            for (const uint32_t entry : seen[image]) groups[entry / 3][1 + entry % 3] = uint32_t(pair_count_);
            ++pair_count_;
        }
        tables.of_vertex(v, MapTables::pair) = uint32_t(first_pair);
        tables.of_vertex(v, MapTables::pair_end) = uint32_t(pair_count_);
        if (order == Order::listed) continue;
        for (const auto& cell : cells) {
            cell_first.push_back(uint32_t(cell_pairs.size()));
            cell_pairs.insert(cell_pairs.end(), cell.begin(), cell.end());
        }
        cell_first.push_back(uint32_t(cell_pairs.size()));
    }
    first.push_back(uint32_t(pair_groups.size()));
    pairs_ = upload("cameras' views of vertices", GL_RGBA32UI, pairs);
}

void SampleStore::bind_to(const Program& program) const {
    program.bind_if_used("pairs", pairs_.texture);
    program.bind_if_used("groups", groups_.texture);
    program.bind_if_used("samples_by_group", by_group_.texture);
    program.bind_if_used("samples_by_texel", by_texel_.texture);
    program.bind_if_used("listed_samples", listed_.texture);
    program.bind_if_used("listed_groups", listed_groups_.texture);
    program.set_if_used("pair_count", int(pair_count_));
    program.set_if_used("sample_count", int(sample_count_));
}

}  // namespace radiafit

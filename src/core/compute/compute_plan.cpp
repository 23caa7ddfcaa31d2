#include "compute/compute_plan.h"

#include <fmt/format.h>

#include <algorithm>

#include "compute/map_tables.h"
#include "compute/sample_sweeps.h"

namespace radiafit {
namespace {

class Plan {
public:
    Plan(const TriangleAtlas& atlas, const VertexRings& rings, const LfmLayout& layout, Accumulate accumulate)
        : tiles_(atlas.tile_count()),
          vertices_(rings.vertex_count()),
          terms_(uint64_t(layout.terms())),
          elements_(layout.size() / 4),
          scatters_(accumulate != Accumulate::gather),
          word_bytes_(accumulate == Accumulate::scatter_fixed ? 8 : 4) {
        add("smoothed maps", fmt::format("{} texels x 4 floats", elements_), 3 * elements_, 16 * elements_);
        if (!scatters_) return;
        add("sums of maps' gradients and squares", fmt::format("2 x {} texels x 3 sums", elements_), 6 * elements_,
            6 * elements_ * word_bytes_);
        add("scales of sums", "9 of a vertex", 9 * vertices_, 16 * 9 * vertices_);
    }
    void add(std::string array, std::string shape, uint64_t count, uint64_t bytes) {
        arrays.push_back({std::move(array), std::move(shape), count, bytes});
    }
    /// Look-ups, their values at x and along d, and what samples add to them.
    void add_pairs(const std::string& shape, uint64_t pairs) {
        const uint64_t sums = scatters_ ? 6 * terms_ * word_bytes_ : 0;
        add("cameras' views of vertices, at most", shape, pairs, pairs * (32 + 32 * terms_ + sums));
    }
    void add_corners() {
        const uint64_t sums = 3 * tiles_ * tile_sums;
        add("sums of triangles", fmt::format("{} x {} of each corner", tiles_, tile_sums), sums,
            sums * (scatters_ ? 3 * word_bytes_ : 16));
    }
    /// more: bytes of tables that lead to samples.
    void add_tables(const TriangleAtlas& atlas, uint64_t more) {
        const uint64_t words = MapTables::vertex_words * vertices_ + (MapTables::tile_words + 9) * tiles_;
        const uint64_t tables = more + 4 * words + 8 * atlas.used_texels() + 4 * elements_ / terms_;
        add("tables, at most", "of samples, and once more while they are made", tables / 2, 2 * tables);
    }
    std::vector<PlannedArray> arrays;

    uint64_t tiles_, vertices_, terms_, elements_;
    bool scatters_;
    uint64_t word_bytes_;  ///< of a sum that samples scatter into
};

}  // namespace

std::vector<PlannedArray> plan_cached_samples(const TriangleAtlas& atlas, const VertexRings& rings,
                                              const LfmLayout& layout, Accumulate accumulate, uint64_t images,
                                              uint64_t samples, uint64_t sample_bytes) {
    Plan plan(atlas, rings, layout, accumulate);
    const uint64_t pairs = plan.vertices_ * images, groups = std::min(samples, plan.tiles_ * images);
    plan.add_pairs(fmt::format("{} vertices x {} images", plan.vertices_, images), pairs);
    plan.add_corners();
    if (plan.scatters_) {
        plan.add("groups of samples, at most", "those of a triangle and an image, and once more", groups, 32 * groups);
        plan.add_tables(atlas, 0);
        plan.add("samples, about", "8 bytes, and with their groups for the device and on it", 3 * samples,
                 (8 + 2 * (sample_bytes + 4)) * samples);
    } else {
        plan.add("sums of cameras' views of vertices", "and squares", pairs, pairs * 32 * plan.terms_);
        plan.add("groups of samples, at most", "those of a triangle and an image", groups,
                 groups * (16 + 48 * plan.terms_));
        plan.add_tables(atlas, 4 * (3 * groups + pairs));
        plan.add("samples, about", "8 bytes, and in two orders for the device and on it", 5 * samples,
                 (8 + 4 * sample_bytes) * samples);
    }
    plan.add("samples by image, until they are sorted", "once more", samples, 8 * samples);
    return plan.arrays;
}

std::vector<PlannedArray> plan_redistribution(const Dataset& dataset, const TriangleAtlas& atlas,
                                              const VertexRings& rings, const LfmLayout& layout, Accumulate accumulate,
                                              std::span<const uint32_t> views, const StreamOptions& stream) {
    Plan plan(atlas, rings, layout, accumulate);
    plan.add_pairs(fmt::format("{} vertices in one image", plan.vertices_), plan.vertices_);
    plan.add_corners();
    if (!plan.scatters_)
        plan.add("sums of triangles in one image", "2 of each corner and term", 6 * plan.tiles_ * plan.terms_,
                 96 * plan.tiles_ * plan.terms_);
    plan.add_tables(atlas, 0);
    const int bits = ImageStream(dataset, StreamSource::disk, stream.space).bits();
    const auto [width, height] = largest_image(dataset, views);
    const uint64_t pixels = uint64_t(width) * uint64_t(height);
    plan_images(plan.arrays, dataset, views, 1, bits, stream.keep_on_device);
    plan.add("item buffer and depth", fmt::format("{} x {}", width, height), pixels,
             pixels * (bits == 8 ? 8 + 4 : 16 + 4));
    plan.add("mesh", fmt::format("{} triangles, attributes and indices; frames of vertices", plan.tiles_), plan.tiles_,
             plan.tiles_ * 3 * (3 * 12 + 4 + 12 + 4) + plan.vertices_ * 64);
    return plan.arrays;
}

}  // namespace radiafit

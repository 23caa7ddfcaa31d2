#include "compute/scatter_sums.h"

#include <cmath>

namespace radiafit {
namespace {

constexpr size_t scales = 9;                                           // of a vertex, shaders/compute/scales.glsl
constexpr size_t corner_bytes = 3 * tile_sums * 3 * sizeof(uint32_t);  // of a tile: a word of all sums of its corners

/// As shaders/compute/accumulate.glsl numbers them.
Defines accumulate_define(Accumulate accumulate) {
    const int number = accumulate == Accumulate::scatter_fixed ? 1 : accumulate == Accumulate::scatter_float ? 2 : 3;
    return {{"ACCUMULATE", std::to_string(number)}};
}

}  // namespace

ScatterSums::ScatterSums(const SweepResources& resources, Accumulate accumulate, size_t pairs, float target_scale)
    : r_(resources), accumulate_(accumulate), pair_count_(pairs) {
    const size_t elements = r_.layout.size() / 4, of_pairs = pairs * size_t(r_.options.terms);
    element_sums_ = make("sums of maps' gradients", elements);
    element_squares_ = make("sums of maps' squares", elements);
    pair_sums_ = make("sums of cameras' views of vertices", of_pairs);
    pair_squares_ = make("squares of cameras' views of vertices", of_pairs);
    corner_sums_ = make("sums of triangles", r_.tables.tile_count() * 3 * tile_sums);
    const size_t vertices = r_.layout.problem_count();
    if (accumulate == Accumulate::scatter_fixed) {
        scales_ = FetchedBuffer::written("scales of sums", vertices * scales);
        scale_passes_[0] = r_.program_over(vector::trial, "scales.comp");
        scale_passes_[1] = r_.program_over(vector::p, "scales.comp", {{"ALONG", ""}});
        scale_passes_[1].bind("direction", r_.vectors[vector::d].texture);
        for (const Program& pass : scale_passes_) {
            pass.bind("Scales", scales_.buffer);
            pass.set("most_target", 65535.0f * target_scale);
        }
    }
    for (const bool diagonal : {false, true}) {
        spread_passes_[diagonal] =
            r_.program("spread.comp", defines() + (diagonal ? Defines{{"DIAGONAL", ""}} : Defines{}));
        bind_to(spread_passes_[diagonal]);
        spread_passes_[diagonal].set("pair_count", int(pairs));
    }
}

ScatterSums::Words ScatterSums::make(const char* what, size_t vec3s) const {
    Words made;
    for (int i = 0; i < (accumulate_ == Accumulate::scatter_fixed ? 2 : 1); ++i)
        made.push_back(storage_buffer(what, vec3s * 3 * sizeof(uint32_t)));
    return made;
}

Defines ScatterSums::defines() const { return accumulate_define(accumulate_); }

Defines ScatterSums::reading_defines() const {
    const bool floats = accumulate_ == Accumulate::scatter_float;
    return Defines{{"SUMS", "sums_scattered"}} + accumulate_define(floats ? Accumulate::scatter_swap : accumulate_);
}

void ScatterSums::bind_to(const Program& program) const {
    const auto bind = [&](const char* name, const Words& words) {
        for (size_t i = 0; i < words.size(); ++i)
            program.bind_if_used(std::string(name) + "[" + std::to_string(i) + "]", words[i]);
    };
    bind("ElementSums", element_sums_);
    bind("ElementSquares", element_squares_);
    bind("PairSums", pair_sums_);
    bind("PairSquares", pair_squares_);
    bind("CornerSums", corner_sums_);
    program.bind_if_used("scales", scales_.texture);
}

// Sums of pairs are zero already: spread() leaves them so.
void ScatterSums::begin_gradient(bool diagonal) {
    for (Words* sums : {&element_sums_, &corner_sums_})
        for (Buffer& word : *sums) word.clear();
    if (diagonal)
        for (Buffer& word : element_squares_) word.clear();
    if (scale_passes_[0]) scale_passes_[0].dispatch(r_.layout.problem_count());
}

void ScatterSums::begin_line() {
    for (Buffer& word : corner_sums_) word.clear();
    if (scale_passes_[1]) scale_passes_[1].dispatch(r_.layout.problem_count());
}

void ScatterSums::spread(const Texture& pairs, bool diagonal) {
    const Program& pass = spread_passes_[diagonal];
    pass.bind("pairs", pairs);
    pass.dispatch(r_.problems.groups(pair_count_));
}

SampleCounter::SampleCounter(const MapTables& tables, float target_scale, double most_samples)
    : tiles_(tables.tile_count()),
      scale_(std::exp2(std::floor(60 - std::log2(most_samples) - std::log2(65535 * double(target_scale))))),
      tile_samples_(storage_buffer("samples of triangles", tiles_ * sizeof(uint32_t))) {
    for (Buffer& word : corner_sums_) word = storage_buffer("sums of triangles", tiles_ * corner_bytes);
}

Defines SampleCounter::defines() { return accumulate_define(Accumulate::scatter_fixed) + Defines{{"TARGET_ONLY", ""}}; }

void SampleCounter::bind_to(const Program& program) const {
    program.bind("CornerSums[0]", corner_sums_[0]);
    program.bind("CornerSums[1]", corner_sums_[1]);
    program.bind("TileSamples", tile_samples_);
    program.set("target_sum_scale", float(scale_));
}

TileStatistics SampleCounter::read() const {
    TileStatistics statistics;
    statistics.samples.resize(tiles_);
    tile_samples_.read(0, tiles_ * sizeof(uint32_t), statistics.samples.data());
    std::vector<uint32_t> low(tiles_ * corner_bytes / sizeof(uint32_t)), high(low.size());
    corner_sums_[0].read(0, tiles_ * corner_bytes, low.data());
    corner_sums_[1].read(0, tiles_ * corner_bytes, high.data());
    for (size_t corner = 0; corner < 3 * tiles_; ++corner)
        for (size_t at = corner * tile_sums * 3; at < corner * tile_sums * 3 + 3; ++at)
            statistics.targets.push_back(float(double(uint64_t(high[at]) << 32 | low[at]) / scale_));
    return statistics;
}

}  // namespace radiafit

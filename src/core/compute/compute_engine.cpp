#include "compute/compute_engine.h"

#include <algorithm>

#include "model/lfm_start.h"

namespace radiafit {

ComputeEngine::ComputeEngine(const TriangleAtlas& atlas, const VertexRings& rings, const LfmOptions& options,
                             float target_scale, Accumulate accumulate)
    : options_((check_options(options), options)),
      accumulate_(accumulate_here(accumulate)),
      layout_(rings, atlas, options.view_side, options.terms),
      tables_(atlas, rings, layout_, target_scale),
      rings_(&rings),
      smoothed_(FetchedBuffer::written("maps", layout_.size() / 4)),
      resources_{options_, layout_, tables_,
                 make({.problems = "vertices_given",
                       .problem_count = 3 * layout_.problem_count(),
                       .given_bytes = layout_.problem_count() * of_vertex::count * 16,
                       .vec4s = layout_.size() / 4,
                       .product_bytes = layout_.problem_count() * 16,
                       // Of passes over a tile's pixels: what tile_pixels.glsl shares, and tables.glsl.
                       .shared_bytes_each = 16 * (1 + size_t(std::max(3 * options.terms + 3, 12))),
                       .items = atlas.texels_per_tile()}),
                 vectors_} {}

ComputeEngine::ComputeEngine(const Dataset& dataset, const TriangleAtlas& atlas, const VertexRings& rings,
                             const SampleList& samples, const LfmOptions& options, Accumulate accumulate)
    : ComputeEngine(atlas, rings, options, samples.scale, accumulate) {
    sweeps_ = accumulate_ == Accumulate::gather
                  ? make_cached_gather(resources_, dataset, atlas, rings, samples)
                  : make_cached_scatter(resources_, dataset, atlas, rings, samples, accumulate_);
    make_programs();
}

ComputeEngine::ComputeEngine(const Dataset& dataset, const TriangleAtlas& atlas, const VertexRings& rings,
                             std::vector<uint32_t> views, const LfmOptions& options, const StreamOptions& stream,
                             Accumulate accumulate)
    : ComputeEngine(atlas, rings, options, 1, accumulate) {
    tables_.upload();
    sweeps_ = accumulate_ == Accumulate::gather
                  ? make_streamed_gather(resources_, dataset, atlas, std::move(views), stream)
                  : make_streamed_scatter(resources_, dataset, atlas, std::move(views), stream, accumulate_);
    make_programs();
}

void ComputeEngine::make_programs() {
    const auto over = [&](int maps, const std::string& file, const Defines& defines = {}) {
        Program made = resources_.program_over(maps, file, sweeps_->sums() + defines);
        sweeps_->bind_to(made);
        return made;
    };
    laplacian_ = over(vector::trial, "laplacian.comp");
    laplacian_.bind("Smoothed", smoothed_.buffer);
    for (const bool diagonal : {false, true}) {
        Program& made = gradient_passes_[diagonal];
        made = over(vector::trial, "gradient.comp", diagonal ? Defines{{"DIAGONAL", ""}} : Defines{});
        made.bind("smoothed", smoothed_.texture);
        made.bind("Gradient", vectors_[vector::trial_g].buffer);
        made.bind_if_used("Fresh", vectors_[vector::fresh].buffer);
    }
    line_ = over(vector::p, "line.comp");
    line_.bind("direction", vectors_[vector::d].texture);
    line_.set("penalized", int(options_.corrections.penalty_curvature));
    compile("", layout_.problem_count());
    count_bytes();
}

ProblemStatistics ComputeEngine::count() {
    const TileStatistics of_tiles = sweeps_->count();
    const size_t vertices = layout_.problem_count();
    std::vector<float> all(vertices * of_vertex::count * 4);
    ProblemStatistics statistics;
    statistics.samples.assign(vertices, 0);
    statistics.mean.assign(3 * vertices, 0.0f);
    for (size_t v = 0; v < vertices; ++v) {
        double sum[3] = {};
        for (const Corner& corner : rings_->ring(v)) {
            const float* targets = &of_tiles.targets[(3 * size_t(corner.triangle) + corner.corner) * 3];
            for (size_t c = 0; c < 3; ++c) sum[c] += double(targets[c]);
            statistics.samples[v] += of_tiles.samples[corner.triangle];
        }
        const uint32_t samples = statistics.samples[v];
        const size_t texels = layout_.surface_texels(v);
        float* of = &all[v * of_vertex::count * 4];
        of[4 * of_vertex::density] = samples ? float(inverse_density(options_, texels, samples)) : 1.0f;
        of[4 * of_vertex::density + 1] = float(texels);
        of[4 * of_vertex::density + 2] = float(samples);
        for (size_t c = 0; c < 3 && samples; ++c) {
            const float mean = statistics.mean[3 * v + c] = float(sum[c] / samples);
            of[4 * of_vertex::lambda_view + c] = scaled_lambda_view(options_, texels, mean);
        }
    }
    numbers_->given().write(0, all.size() * sizeof(float), all.data());
    sample_counts_ = statistics.samples;
    return statistics;
}

void ComputeEngine::gradient_pass(bool diagonal) {
    sweeps_->gradient_pass(diagonal);
    laplacian_.dispatch(layout_.problem_count());
    const Program& gradient = gradient_passes_[diagonal];
    gradient.set("first_term", first_term_);
    gradient.set("last_term", last_term_);
    gradient.dispatch(layout_.problem_count());
}

void ComputeEngine::directional_pass() {
    sweeps_->directional_pass();
    line_.dispatch(layout_.problem_count());
}

std::vector<float> ComputeEngine::read_problems() const {
    std::vector<float> all(layout_.problem_count() * of_vertex::count * 4);
    numbers_->given().read(0, all.size() * sizeof(float), all.data());
    return all;
}

std::vector<float> ComputeEngine::sums_of(int what, const std::vector<float>& problems) const {
    std::vector<float> out;
    for (size_t i = 0; i < problem_count(); ++i)
        out.push_back(problems[4 * (i / 3 * of_vertex::count + size_t(what)) + i % 3]);
    return out;
}

ComputeEngine::Line ComputeEngine::read_line() const {
    const std::vector<float> problems = read_problems();
    const auto sums = [&](int i) { return sums_of(of_vertex::line + i, problems); };
    return {sums(0), sums(1), sums(2), sums(3)};
}

}  // namespace radiafit

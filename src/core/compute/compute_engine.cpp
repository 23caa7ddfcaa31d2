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
      problems_(3 * layout_.problem_count(), "vertices_given"),
      rings_(&rings),
      resources_{options_, layout_, tables_, problems_, vectors_} {
    problems_.make_given(layout_.problem_count() * of_vertex::count * 16);
    smoothed_ = make_vector();
    for (int v = 0; v < vector::first_own; ++v) vectors_.push_back(make_vector());
}

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
    const auto program = [&](int maps, const std::string& file, const Defines& defines = {}) {
        Program made = resources_.program_over(maps, file, sweeps_->sums() + defines);
        sweeps_->bind_to(made);
        return made;
    };
    laplacian_ = program(vector::trial, "laplacian.comp");
    laplacian_.bind("Smoothed", smoothed_.buffer);
    for (const bool diagonal : {false, true}) {
        Program& made = gradient_passes_[diagonal];
        made = program(vector::trial, "gradient.comp", diagonal ? Defines{{"DIAGONAL", ""}} : Defines{});
        made.bind("smoothed", smoothed_.texture);
        made.bind("Gradient", vectors_[vector::trial_g].buffer);
        made.bind_if_used("Fresh", vectors_[vector::fresh].buffer);
    }
    line_ = program(vector::p, "line.comp");
    line_.bind("direction", vectors_[vector::d].texture);
    line_.set("penalized", int(options_.mends.penalty_curvature));
    dot_ = resources_.program("dot.comp");
    make_room({});
    for (const Step which : {Step::judge_trial, Step::step_length}) problems_.program(which);
    for (const Update which : {Update::update_direction, Update::advance}) update_program(which);
}

FetchedBuffer ComputeEngine::make_vector() const { return FetchedBuffer::written("maps", layout_.size() / 4); }

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
    problems_.given().write(0, all.size() * sizeof(float), all.data());
    sample_counts_ = statistics.samples;
    return statistics;
}

void ComputeEngine::reset(std::span<const float> start) {
    for (FetchedBuffer& v : vectors_) v.buffer.clear();
    vectors_[vector::trial].buffer.write(0, start.size_bytes(), start.data());
    vectors_[vector::p].buffer.write(0, start.size_bytes(), start.data());  // what a problem without samples returns
    problems_.reset([&](size_t problem) { return sample_counts_[problem / 3]; });
}

void ComputeEngine::make_room(const Room& room) {
    vectors_.resize(std::min(vectors_.size(), size_t(room.vector_count())));
    for (size_t v = vector::first_own; v < vectors_.size(); ++v) vectors_[v].buffer.clear();
    while (vectors_.size() < size_t(room.vector_count())) vectors_.push_back(make_vector());
    problems_.make_products(room.product_count(), layout_.problem_count() * 16);
    problems_.clear_own();
}

void ComputeEngine::gradient_pass(bool diagonal) {
    sweeps_->gradient(diagonal);
    laplacian_.dispatch(layout_.problem_count());
    const Program& gradient = gradient_passes_[diagonal];
    gradient.set("first_term", first_term_);
    gradient.set("last_term", last_term_);
    gradient.dispatch(layout_.problem_count());
}

void ComputeEngine::directional_pass() {
    sweeps_->line();
    line_.dispatch(layout_.problem_count());
}

void ComputeEngine::dot(std::initializer_list<DotProduct> products) {
    problems_.bind_to(dot_);
    for (const DotProduct& product : products) {
        const bool weighted = product.weight != vector::none;
        dot_.bind("left", vectors_[size_t(product.a)].texture);
        dot_.bind("right", vectors_[size_t(product.b)].texture);
        dot_.bind("weights", vectors_[size_t(weighted ? product.weight : product.a)].texture);
        dot_.set("weighted", int(weighted));
        dot_.set("product", product.into);
        dot_.dispatch(layout_.problem_count());
    }
}

void ComputeEngine::step(Step which, const Turn& turn) { problems_.step(which, turn); }

const Program& ComputeEngine::update_program(Update which) {
    Program& made = updates_[which];
    if (made) return made;
    made = resources_.program("update.comp", ProblemBuffers::update_defines(which));
    return made;
}

void ComputeEngine::update(Update which, std::initializer_list<int> vectors, std::initializer_list<int> numbers,
                           std::initializer_list<float> constants) {
    const Program& update = update_program(which);
    for (size_t k = 0; k < vectors.size(); ++k)
        update.bind_if_used("Vectors[" + std::to_string(k) + "]", vectors_[size_t(std::data(vectors)[k])].buffer);
    problems_.tell_update(update, numbers, constants);
    update.dispatch(layout_.problem_count());
}

void ComputeEngine::read(const Buffer& buffer, std::span<float> out) { buffer.read(0, out.size_bytes(), out.data()); }

std::vector<float> ComputeEngine::read_problems() const {
    std::vector<float> all(layout_.problem_count() * of_vertex::count * 4);
    read(problems_.given(), all);
    return all;
}

std::vector<float> ComputeEngine::sums_of(int what, const std::vector<float>& problems) const {
    std::vector<float> out;
    for (size_t i = 0; i < problem_count(); ++i)
        out.push_back(problems[4 * (i / 3 * of_vertex::count + size_t(what)) + i % 3]);
    return out;
}

ComputeEngine::Evaluation ComputeEngine::read_evaluation() const {
    Evaluation result{sums_of(of_vertex::error, read_problems()), {}, {}};
    result.gradient.resize(layout_.size());
    result.diagonal.resize(layout_.size());
    read(vectors_[vector::trial_g].buffer, result.gradient);
    read(vectors_[vector::fresh].buffer, result.diagonal);
    return result;
}

ComputeEngine::Line ComputeEngine::read_line() const {
    const std::vector<float> problems = read_problems();
    const auto sums = [&](int i) { return sums_of(of_vertex::line + i, problems); };
    return {sums(0), sums(1), sums(2), sums(3)};
}

void ComputeEngine::set_line(std::span<const float> p, std::span<const float> d) {
    vectors_[vector::p].buffer.write(0, p.size_bytes(), p.data());
    vectors_[vector::d].buffer.write(0, d.size_bytes(), d.data());
}

}  // namespace radiafit

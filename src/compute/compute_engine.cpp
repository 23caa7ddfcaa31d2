#include "compute/compute_engine.h"

#include <algorithm>

#include "fragment/map_vector.h"
#include "model/lfm_start.h"

namespace radiafit {
namespace {

constexpr size_t lanes = 32;  // of a work group

/// shaders/compute/problems.glsl
namespace of_problem {
enum { density, lambda_view, error, line, count = line + 4 };
}
constexpr size_t tile_sums = 4;

}  // namespace

ComputeEngine::ComputeEngine(const Dataset& dataset, const TriangleAtlas& atlas, const VertexRings& rings,
                             const SampleList& samples, const LfmOptions& options)
    : options_((check_options(options), options)),
      layout_(rings, atlas, options.view_side, options.terms),
      samples_(dataset, atlas, rings, layout_, samples, options, lanes),
      problems_(3 * layout_.problem_count(), "vertices_given", lanes),
      rings_(&rings) {
    const size_t vertices = layout_.problem_count(), terms = size_t(options.terms);
    problems_.make_given(vertices * of_problem::count * 16);
    for (FetchedBuffer* of_pairs : {&pair_values_, &pair_slopes_, &pair_sums_, &pair_squares_})
        *of_pairs = FetchedBuffer::written("cameras' views of vertices", samples_.pair_count() * terms);
    group_sums_ = FetchedBuffer::written("sums of groups of samples", samples_.group_count() * 3 * terms);
    tile_sums_ = FetchedBuffer::written("sums of triangles", samples_.tile_count() * 3 * tile_sums);
    smoothed_ = make_vector();
    for (int v = 0; v < vector::first_own; ++v) vectors_.push_back(make_vector());
    make_programs();
    make_room({});
    for (const Step which : {Step::judge_trial, Step::step_length}) problems_.program(which);
    for (const Update which : {Update::update_direction, Update::advance}) update_program(which);
}

void ComputeEngine::make_programs() {
    const Texture &trial = vectors_[vector::trial].texture, &p = vectors_[vector::p].texture,
                  &d = vectors_[vector::d].texture;
    const auto over = [&](const Texture& maps, const char* file, const Defines& defines = {}) {
        Program made = program(file, defines);
        made.bind("maps", maps);
        return made;
    };
    count_ = program("count.comp");
    look_up_ = program("look_up.comp");
    look_up_along_ = over(d, "look_up.comp");
    look_up_along_.bind("PairValues", pair_slopes_.buffer);
    laplacian_ = over(trial, "laplacian.comp");
    laplacian_.bind("Smoothed", smoothed_.buffer);
    group_pass_ = over(trial, "tile_groups.comp");
    square_pass_ = over(trial, "tile_groups.comp", {{"SQUARES", ""}});
    pair_pass_ = program("pair_sums.comp");
    for (const bool diagonal : {false, true}) {
        const Defines defines = diagonal ? Defines{{"DIAGONAL", ""}} : Defines{};
        texel_passes_[diagonal] = over(trial, "tile_texels.comp", defines);
        gradient_passes_[diagonal] = over(trial, "gradient.comp", defines);
        gradient_passes_[diagonal].bind("smoothed", smoothed_.texture);
        gradient_passes_[diagonal].bind("pair_sums", pair_sums_.texture);
        gradient_passes_[diagonal].bind_if_used("pair_squares", pair_squares_.texture);
        for (const Program* made : {&texel_passes_[diagonal], &gradient_passes_[diagonal]}) {
            made->bind("Gradient", vectors_[vector::trial_g].buffer);
            made->bind_if_used("Fresh", vectors_[vector::fresh].buffer);
        }
    }
    tile_line_ = over(p, "tile_line.comp");
    line_ = over(p, "line.comp");
    for (const Program* made : {&tile_line_, &line_}) made->bind("direction", d);
    tile_line_.bind("pair_slopes", pair_slopes_.texture);
    line_.set("penalized", int(options_.mends.penalty_curvature));
    dot_ = program("dot.comp");
}

FetchedBuffer ComputeEngine::make_vector() const { return FetchedBuffer::written("maps", layout_.size() / 4); }

/// With all that programs share.
Program ComputeEngine::program(const std::string& file, const Defines& more) const {
    Program made = Program::compute("compute/" + file, problems_.defines() +
                                                           Defines{{"TERMS", std::to_string(options_.terms)},
                                                                   {"VIEW_SIDE", std::to_string(options_.view_side)}} +
                                                           samples_.defines() + loss_defines(options_.loss) + more);
    samples_.bind_to(made);
    problems_.bind_to(made);
    made.bind_if_used("pair_values", pair_values_.texture);
    made.bind_if_used("group_sums", group_sums_.texture);
    made.bind_if_used("GroupSums", group_sums_.buffer);
    made.bind_if_used("tile_sums", tile_sums_.texture);
    made.bind_if_used("TileSums", tile_sums_.buffer);
    made.set_if_used("lambda_surface", options_.lambda_surface);
    made.set_if_used("mu", options_.mu);
    made.set_if_used("bounds", options_.lower, options_.upper);
    made.set_if_used("paper_penalty", int(options_.mode == Mode::paper));
    return made;
}

ProblemStatistics ComputeEngine::count() {
    count_.dispatch(samples_.tile_count());
    std::vector<float> of_tiles(samples_.tile_count() * 3 * tile_sums * 4);
    read(tile_sums_.buffer, of_tiles);
    const size_t vertices = layout_.problem_count();
    std::vector<float> all(vertices * of_problem::count * 4);
    ProblemStatistics statistics;
    statistics.samples.assign(vertices, 0);
    statistics.mean.assign(3 * vertices, 0.0f);
    for (size_t v = 0; v < vertices; ++v) {
        double sum[3] = {};
        for (const Corner& corner : rings_->ring(v)) {
            const float* of_tile = &of_tiles[(3 * size_t(corner.triangle) + corner.corner) * tile_sums * 4];
            for (size_t c = 0; c < 3; ++c) sum[c] += double(of_tile[c]);
            statistics.samples[v] += samples_.tile_samples()[corner.triangle];
        }
        const uint32_t samples = statistics.samples[v];
        const size_t texels = layout_.surface_texels(v);
        float* of = &all[v * of_problem::count * 4];
        of[4 * of_problem::density] = samples ? float(inverse_density(options_, texels, samples)) : 1.0f;
        of[4 * of_problem::density + 1] = float(texels);
        for (size_t c = 0; c < 3 && samples; ++c) {
            const float mean = statistics.mean[3 * v + c] = float(sum[c] / samples);
            of[4 * of_problem::lambda_view + c] = scaled_lambda_view(options_, texels, mean);
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

void ComputeEngine::look_up(const FetchedBuffer& maps) {
    look_up_.bind("maps", maps.texture);
    look_up_.bind("PairValues", pair_values_.buffer);
    look_up_.dispatch(layout_.problem_count());
}

void ComputeEngine::sum_over_pairs(const FetchedBuffer& into) {
    pair_pass_.bind("PairSums", into.buffer);
    pair_pass_.dispatch(layout_.problem_count());
}

void ComputeEngine::gradient_pass(bool diagonal) {
    const size_t vertices = layout_.problem_count(), tiles = samples_.tile_count();
    look_up(vectors_[vector::trial]);
    group_pass_.dispatch(tiles);
    sum_over_pairs(pair_sums_);
    if (diagonal) {
        square_pass_.dispatch(tiles);
        sum_over_pairs(pair_squares_);
    }
    texel_passes_[diagonal].dispatch(tiles);
    laplacian_.dispatch(vertices);
    const Program& gradient = gradient_passes_[diagonal];
    gradient.set("first_term", first_term_);
    gradient.set("last_term", last_term_);
    gradient.dispatch(vertices);
}

void ComputeEngine::directional_pass() {
    look_up(vectors_[vector::p]);
    look_up_along_.dispatch(layout_.problem_count());
    tile_line_.dispatch(samples_.tile_count());
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
    made = program("update.comp", ProblemBuffers::update_defines(which));
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
    std::vector<float> all(layout_.problem_count() * of_problem::count * 4);
    read(problems_.given(), all);
    return all;
}

std::vector<float> ComputeEngine::sums_of(int what, const std::vector<float>& problems) const {
    std::vector<float> out;
    for (size_t i = 0; i < problem_count(); ++i)
        out.push_back(problems[4 * (i / 3 * of_problem::count + size_t(what)) + i % 3]);
    return out;
}

ComputeEngine::Evaluation ComputeEngine::read_evaluation() const {
    Evaluation result{sums_of(of_problem::error, read_problems()), {}, {}};
    result.gradient.resize(layout_.size());
    result.diagonal.resize(layout_.size());
    read(vectors_[vector::trial_g].buffer, result.gradient);
    read(vectors_[vector::fresh].buffer, result.diagonal);
    return result;
}

ComputeEngine::Line ComputeEngine::read_line() const {
    const std::vector<float> problems = read_problems();
    const auto sums = [&](int i) { return sums_of(of_problem::line + i, problems); };
    return {sums(0), sums(1), sums(2), sums(3)};
}

void ComputeEngine::set_line(std::span<const float> p, std::span<const float> d) {
    vectors_[vector::p].buffer.write(0, p.size_bytes(), p.data());
    vectors_[vector::d].buffer.write(0, d.size_bytes(), d.data());
}

}  // namespace radiafit

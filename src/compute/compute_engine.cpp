#include "compute/compute_engine.h"

#include <algorithm>
#include <bit>

#include "fragment/map_vector.h"
#include "model/lfm_start.h"

namespace radiafit {
namespace {

constexpr size_t lanes = 32;   // of a work group
constexpr size_t block = 256;  // problems that one invocation of summary.comp looks at

/// shaders/compute/problems.glsl
namespace of_problem {
enum { density, lambda_view, targets, error, line, residuals = line + 4, count };
}

size_t problem_groups(size_t problems) { return (problems + lanes - 1) / lanes; }

}  // namespace

ComputeEngine::ComputeEngine(const Dataset& dataset, const TriangleAtlas& atlas, const VertexRings& rings,
                             const SampleList& samples, const LfmOptions& options)
    : options_((check_options(options), options)),
      layout_(rings, atlas, options.view_side, options.terms),
      samples_(dataset, atlas, rings, layout_, samples, options) {
    const size_t vertices = layout_.problem_count(), terms = size_t(options.terms);
    problems_ = storage_buffer("sums of vertices", vertices * of_problem::count * 16);
    numbers_ = storage_buffer("numbers of problems", problem_count() * number_count * sizeof(float));
    summaries_ = storage_buffer("summaries", (problem_count() + block - 1) / block * 16);
    pair_sums_ = FetchedBuffer("sums of cameras' views", GL_RGBA32F, samples_.pair_count() * terms * 3 * 16, nullptr);
    smoothed_ = make_vector();
    for (int v = 0; v < vector::first_own; ++v) vectors_.push_back(make_vector());

    count_ = program("count.comp");
    const FetchedBuffer& trial = vectors_[vector::trial];
    for (const bool diagonal : {false, true}) {
        const Defines defines = diagonal ? Defines{{"DIAGONAL", ""}} : Defines{};
        const Program& pairs = pair_passes_[diagonal] = program("pairs.comp", defines);
        pairs.bind("trial", trial.texture);
        pairs.bind("PairSums", pair_sums_.buffer);
        pairs.bind("Smoothed", smoothed_.buffer);
        const Program& gradient = gradient_passes_[diagonal] = program("gradient.comp", defines);
        gradient.bind("trial", trial.texture);
        gradient.bind("pair_sums", pair_sums_.texture);
        gradient.bind("smoothed", smoothed_.texture);
        gradient.bind("Gradient", vectors_[vector::trial_g].buffer);
        gradient.bind_if_used("Fresh", vectors_[vector::fresh].buffer);
    }
    line_ = program("line.comp");
    line_.bind("point", vectors_[vector::p].texture);
    line_.bind("direction", vectors_[vector::d].texture);
    line_.set("penalized", int(options.mends.penalty_curvature));
    dot_ = program("dot.comp");
    summary_ = program("summary.comp");
    summary_.bind("Summaries", summaries_);
    make_room({});
}

FetchedBuffer ComputeEngine::make_vector() const {
    FetchedBuffer vector("maps", GL_RGBA32F, layout_.size() * sizeof(float), nullptr, true);
    vector.buffer.clear();
    return vector;
}

/// With all that programs share.
Program ComputeEngine::program(const std::string& file, const Defines& more) const {
    Program made = Program::compute("compute/" + file, Defines{{"LANES", std::to_string(lanes)},
                                                               {"BLOCK", std::to_string(block)},
                                                               {"NUMBER_COUNT", std::to_string(number_count)},
                                                               {"NUMBER_STATUS", std::to_string(number::status)},
                                                               {"NUMBER_ACCEPTED", std::to_string(number::accepted)},
                                                               {"TERMS", std::to_string(options_.terms)},
                                                               {"VIEW_SIDE", std::to_string(options_.view_side)}} +
                                                           samples_.defines() + loss_defines(options_.loss) + more);
    samples_.bind_to(made);
    made.bind_if_used("Problems", problems_);
    made.bind_if_used("Numbers", numbers_);
    made.set_if_used("lambda_surface", options_.lambda_surface);
    made.set_if_used("mu", options_.mu);
    made.set_if_used("bounds", options_.lower, options_.upper);
    made.set_if_used("paper_penalty", int(options_.mode == Mode::paper));
    return made;
}

ProblemStatistics ComputeEngine::count() {
    count_.dispatch(layout_.problem_count());
    std::vector<float> all = read_problems();
    const size_t vertices = layout_.problem_count();
    ProblemStatistics statistics;
    statistics.samples.resize(vertices);
    statistics.mean.assign(3 * vertices, 0.0f);
    for (size_t v = 0; v < vertices; ++v) {
        float* of = &all[v * of_problem::count * 4];
        const auto samples = uint32_t(of[4 * of_problem::targets + 3]);
        const size_t texels = layout_.surface_texels(v);
        statistics.samples[v] = samples;
        of[4 * of_problem::density] = samples ? float(inverse_density(options_, texels, samples)) : 1.0f;
        of[4 * of_problem::density + 1] = float(texels);
        for (size_t c = 0; c < 3 && samples; ++c) {
            const float mean = of[4 * of_problem::targets + c] / float(samples);
            statistics.mean[3 * v + c] = mean;
            of[4 * of_problem::lambda_view + c] = scaled_lambda_view(options_, texels, mean);
        }
    }
    problems_.write(0, all.size() * sizeof(float), all.data());
    sample_counts_ = statistics.samples;
    return statistics;
}

void ComputeEngine::reset(std::span<const float> start) {
    using real = float;
    for (FetchedBuffer& v : vectors_) v.buffer.clear();
    vectors_[vector::trial].buffer.write(0, start.size_bytes(), start.data());
    vectors_[vector::p].buffer.write(0, start.size_bytes(), start.data());  // what a problem without samples returns
    std::vector<float> numbers(problem_count() * number_count);
    for (size_t i = 0; i < problem_count(); ++i) {
        float* of = &numbers[i * number_count];
        of[number::error] = HUGE_ERROR;
        of[number::step_factor] = 1;
        of[number::status] = float(sample_counts_[i / 3] ? Status::active : Status::no_samples);
    }
    numbers_.write(0, numbers.size() * sizeof(float), numbers.data());
}

void ComputeEngine::make_room(const Room& room) {
    room_ = room;
    vectors_.resize(std::min(vectors_.size(), size_t(room.vector_count())));
    for (size_t v = vector::first_own; v < vectors_.size(); ++v) vectors_[v].buffer.clear();
    while (vectors_.size() < size_t(room.vector_count())) vectors_.push_back(make_vector());
    products_ = storage_buffer("products", layout_.problem_count() * size_t(room.product_count()) * 16);
    std::vector<float> numbers = read_numbers();
    for (size_t i = 0; i < problem_count(); ++i)
        std::fill_n(&numbers[i * number_count + number::first_own], number_count - number::first_own, 0.0f);
    numbers_.write(0, numbers.size() * sizeof(float), numbers.data());
}

void ComputeEngine::gradient_pass(bool diagonal) {
    pair_passes_[diagonal].dispatch(layout_.problem_count());
    const Program& gradient = gradient_passes_[diagonal];
    gradient.set("first_term", first_term_);
    gradient.set("last_term", last_term_);
    gradient.dispatch(layout_.problem_count());
}

void ComputeEngine::directional_pass() { line_.dispatch(layout_.problem_count()); }

void ComputeEngine::dot(std::initializer_list<DotProduct> products) {
    dot_.bind("Products", products_);
    dot_.set("product_count", room_.product_count());
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

const Program& ComputeEngine::step_program(Step which, const Turn& turn) {
    Program& made = steps_[{which, turn.left_out, turn.first_step}];
    if (made) return made;
    const StepName& name = steps[int(which)];
    Defines defines{{"TEXT", name.file}, {"STEP", name.function}};
    if (turn.left_out)
        defines = defines +
                  Defines{{"LEFT_OUT", std::to_string(turn.left_out)}, {"FIRST_STEP", std::to_string(turn.first_step)}};
    made = program("step.comp", defines);
    return made;
}

void ComputeEngine::step(Step which, const Turn& turn) {
    const Program& step = step_program(which, turn);
    step.bind_if_used("Products", products_);
    step.set_if_used("product_count", room_.product_count());
    step.set_if_used("rule", turn.rule);
    step.set_if_used("restart", turn.restart);
    step.set_if_used("slot", turn.slot);
    step.set_if_used("stop", turn.stop.residual, turn.stop.output_change);
    step.dispatch(problem_groups(problem_count()));
}

const Program& ComputeEngine::update_program(Update which) {
    Program& made = updates_[which];
    if (made) return made;
    const UpdateShape& shape = radiafit::updates[int(which)];
    made = program("update.comp", {{"TEXT", shape.file},
                                   {"UPDATE", shape.function},
                                   {"VECTORS", std::to_string(shape.vectors)},
                                   {"WRITTEN", std::to_string(shape.written)},
                                   {"NUMBERS", std::to_string(shape.numbers)},
                                   {"PRODUCTS", std::to_string(shape.products)}});
    return made;
}

void ComputeEngine::update(Update which, std::initializer_list<int> vectors, std::initializer_list<int> numbers,
                           std::initializer_list<float> constants) {
    const Program& update = update_program(which);
    for (size_t k = 0; k < vectors.size(); ++k)
        update.bind_if_used("Vectors[" + std::to_string(k) + "]", vectors_[size_t(std::data(vectors)[k])].buffer);
    int indices[4] = {};
    float told[4] = {};
    std::ranges::transform(numbers, indices,
                           [](int n) { return n >= number::first_product ? n - number::first_product : n; });
    std::ranges::copy(constants, told);
    update.set_if_used("number_indices", std::span<const int>(indices));
    update.set_if_used("constants", std::span<const float>(told));
    update.bind_if_used("Products", products_);
    update.set_if_used("product_count", room_.product_count());
    update.dispatch(layout_.problem_count());
}

EngineSummary ComputeEngine::summary() {
    const size_t blocks = (problem_count() + block - 1) / block;
    summary_.dispatch(problem_groups(blocks));
    std::vector<std::array<uint32_t, 4>> parts(blocks);
    summaries_.read(0, blocks * sizeof parts[0], parts.data());
    EngineSummary sum;
    for (const auto& [active, accepted, low, high] : parts) {
        sum.active += active;
        sum.accepted += accepted;
        sum.error += std::bit_cast<double>(uint64_t(high) << 32 | low);
    }
    return sum;
}

void ComputeEngine::outcomes(std::span<ProblemOutcome> out) const {
    using real = float;
    const std::vector<float> numbers = read_numbers();
    for (size_t i = 0; i < problem_count(); ++i) {
        const float* of = &numbers[i * number_count];
        out[i] = {of[number::error] < HUGE_ERROR ? of[number::error] : 0, Status(int(of[number::status])),
                  uint32_t(of[number::iterations])};
        if (out[i].status == Status::active) out[i].status = Status::max_iterations;
    }
}

void ComputeEngine::read_errors(std::span<float> out) const {
    const std::vector<float> numbers = read_numbers();
    for (size_t i = 0; i < problem_count(); ++i) out[i] = numbers[i * number_count + number::error];
}

void ComputeEngine::read(const Buffer& buffer, std::span<float> out) { buffer.read(0, out.size_bytes(), out.data()); }

std::vector<float> ComputeEngine::read_problems() const {
    std::vector<float> all(layout_.problem_count() * of_problem::count * 4);
    read(problems_, all);
    return all;
}

std::vector<float> ComputeEngine::read_numbers() const {
    std::vector<float> all(problem_count() * number_count);
    read(numbers_, all);
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

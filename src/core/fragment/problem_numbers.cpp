#include "fragment/problem_numbers.h"

#include <bit>

namespace radiafit {
namespace {

constexpr int most_summaries = 64;

Framebuffer all_layers(const Texture& texture) {
    std::vector<Target> targets;
    for (int layer = 0; layer < texture.layers(); ++layer) targets.push_back({&texture, layer});
    return Framebuffer(targets);
}

}  // namespace

ProblemNumbers::ProblemNumbers(int width, int height, size_t count, std::vector<uint32_t> place,
                               const std::string& problems)
    : count_(count),
      place_(std::move(place)),
      defines_{{"PROBLEMS", problems}},
      state_(GL_RGBA32F, width, height, own_layer),
      target_(all_layers(state_)) {
    program(Step::judge_trial, Turn{});
    program(Step::step_length, Turn{});
    for (const auto& [columns, rows] : summary_sizes(width, height)) {
        summaries_.emplace_back(GL_RGBA32UI, columns, rows);
        summary_targets_.push_back(Framebuffer({{&summaries_.back()}}));
    }
    summary_ = Program::draw("common/whole.vert", "optimize/summary.frag");
    further_summary_ = Program::draw("common/whole.vert", "optimize/summary.frag", {{"FURTHER", ""}});
}

const Program& ProblemNumbers::program(Step which, const Turn& turn) {
    const int layers = ProblemNumbers::layers(room_) - own_layer;
    Program& program = programs_[{which, layers, turn.left_out, turn.first_step}];
    if (!program) {
        const StepName& name = steps[int(which)];
        const Defines text{{"TEXT", name.file}, {"STEP", name.function}, {"OWN_LAYERS", std::to_string(layers)}};
        Defines mends;
        if (turn.left_out)
            mends = {{"LEFT_OUT", std::to_string(turn.left_out)}, {"FIRST_STEP", std::to_string(turn.first_step)}};
        program = Program::draw("common/whole.vert", "optimize/step.frag", defines_ + text + mends);
    }
    return program;
}

void ProblemNumbers::make_room(const Room& room) {
    const int layers = ProblemNumbers::layers(room);
    if (layers != state_.layers()) {
        Texture grown(GL_RGBA32F, state_.width(), state_.height(), layers);
        for (int layer = 0; layer < own_layer; ++layer)
            grown.upload(GL_RGBA, GL_FLOAT, read_places(layer).data(), layer);
        state_ = std::move(grown);
        target_ = all_layers(state_);
    }
    room_ = room;
    const std::vector<float> zero(4 * size_t(state_.width()) * size_t(state_.height()));
    for (int layer = own_layer; layer < layers; ++layer) state_.upload(GL_RGBA, GL_FLOAT, zero.data(), layer);
}

void ProblemNumbers::reset(std::span<const Status> status) {
    using real = float;  // HUGE_ERROR is text shared with GLSL
    std::vector<float> layers[own_layer];
    for (auto& layer : layers) layer.resize(4 * size_t(state_.width()) * size_t(state_.height()));
    for (size_t at = 0; at < layers[0].size(); at += 4) {
        layers[number::error / 4][at + number::error % 4] = HUGE_ERROR;
        layers[number::step_factor / 4][at + number::step_factor % 4] = 1;
        layers[number::status / 4][at + number::status % 4] = float(Status::no_samples);  // where no problem is, too
    }
    for (size_t i = 0; i < count_; ++i)
        layers[number::status / 4][4 * (place_.empty() ? i : place_[i]) + number::status % 4] = float(status[i]);
    for (int layer = 0; layer < own_layer; ++layer) state_.upload(GL_RGBA, GL_FLOAT, layers[layer].data(), layer);
}

void ProblemNumbers::step(PassRunner& run, Step which, const Turn& turn) {
    const Program& step = program(which, turn);
    step.set_if_used("rule", turn.rule);
    step.set_if_used("restart", turn.restart);
    step.set_if_used("stop", turn.stop.residual, turn.stop.output_change);
    step.set_if_used("slot", turn.slot);
    step.bind("state", state_);
    gl().TextureBarrier();
    run.draw_whole(target_, step);
    gl().TextureBarrier();
}

std::vector<float> ProblemNumbers::read_places(int layer) const {
    std::vector<float> all(4 * size_t(state_.width()) * size_t(state_.height()));
    state_.download(GL_RGBA, GL_FLOAT, all.data(), all.size() * sizeof(float), layer);
    return all;
}

std::vector<float> ProblemNumbers::read_layer(int layer) const {
    std::vector<float> all = read_places(layer);
    if (place_.empty()) return all;
    std::vector<float> out(4 * count_);
    for (size_t i = 0; i < count_; ++i) std::copy_n(&all[4 * size_t(place_[i])], 4, &out[4 * i]);
    return out;
}

std::vector<std::array<int, 2>> ProblemNumbers::summary_sizes(int width, int height) {
    std::vector<std::array<int, 2>> sizes;
    do {
        width = (width + 15) / 16, height = (height + 15) / 16;
        sizes.push_back({width, height});
    } while (width * height > most_summaries);
    return sizes;
}

uint64_t ProblemNumbers::summary_texels(int width, int height) {
    uint64_t texels = 0;
    for (const auto& [columns, rows] : summary_sizes(width, height)) texels += uint64_t(columns) * uint64_t(rows);
    return texels;
}

EngineSummary ProblemNumbers::summary(PassRunner& run) {
    const Texture* from = &state_;
    for (size_t level = 0; level < summaries_.size(); ++level) {
        const Program& program = level == 0 ? summary_ : further_summary_;
        program.bind("source", *from);
        run.draw_whole(summary_targets_[level], program, uint64_t(from->width()) * uint64_t(from->height()));
        from = &summaries_[level];
    }
    std::array<std::array<uint32_t, 4>, most_summaries> parts;
    from->download(GL_RGBA_INTEGER, GL_UNSIGNED_INT, parts.data(), sizeof parts);
    EngineSummary sum;
    for (const auto& [active, accepted, low, high] : std::span(parts).first(size_t(from->width() * from->height()))) {
        sum.active += active;
        sum.accepted += accepted;
        sum.error += std::bit_cast<double>(uint64_t(high) << 32 | low);
    }
    return sum;
}

void ProblemNumbers::outcomes(std::span<ProblemOutcome> out) const {
    using real = float;
    const std::vector<float> first = read_layer(0), second = read_layer(1);
    for (size_t i = 0; i < count_; ++i) {
        const float error = first[4 * i + number::error];
        const float *rest = &second[4 * i], status = rest[number::status % 4];
        out[i] = {error < HUGE_ERROR ? error : 0, Status(int(status)), uint32_t(rest[number::iterations % 4])};
        if (out[i].status == Status::active) out[i].status = Status::max_iterations;
    }
}

void ProblemNumbers::read_errors(std::span<float> out) const {
    const std::vector<float> first = read_layer(0);
    for (size_t i = 0; i < count_; ++i) out[i] = first[4 * i + number::error];
}

Program make_update(Update which, const std::string& vertex_file, const std::string& elements, const Defines& defines) {
    const UpdateShape& shape = updates[int(which)];
    return Program::draw(vertex_file, "optimize/update.frag",
                         defines + Defines{{"ELEMENTS", elements},
                                           {"TEXT", shape.file},
                                           {"UPDATE", shape.function},
                                           {"VECTORS", std::to_string(shape.vectors)},
                                           {"WRITTEN", std::to_string(shape.written)},
                                           {"NUMBERS", std::to_string(shape.numbers)},
                                           {"PRODUCTS", std::to_string(shape.products)}});
}

void ProblemNumbers::tell_update(const Program& update, const Texture& products, std::span<const int> numbers,
                                 std::span<const float> constants) const {
    int indices[4] = {};
    float told[4] = {};
    std::ranges::transform(numbers, indices, [](int n) {  // the optimizer's own begin a layer
        return n >= number::first_product ? n - number::first_product
               : n >= number::first_own   ? n - number::first_own + 4 * own_layer
                                          : n;
    });
    std::ranges::copy(constants, told);
    update.set_if_used("number_indices", std::span<const int>(indices));
    update.set_if_used("constants", std::span<const float>(told));
    update.bind_if_used("state", state_);
    update.bind_if_used("products", products);
}

}  // namespace radiafit

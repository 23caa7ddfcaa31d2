#include "fragment/problem_numbers.h"

namespace radiafit {
namespace {

constexpr int most_summaries = 64;

Framebuffer all_layers(const Texture& texture) {
    std::vector<Target> targets;
    for (int layer = 0; layer < texture.layers(); ++layer) targets.push_back({&texture, layer});
    return Framebuffer(targets);
}

}  // namespace

ProblemNumbers::ProblemNumbers(PassRunner& run, int width, int height, size_t count, std::vector<uint32_t> place,
                               const std::string& problems)
    : DeviceNumbers(count),
      run_(run),
      place_(std::move(place)),
      defines_{{"PROBLEMS", problems}},
      state_(GL_RGBA32F, width, height, own_layer),
      target_(all_layers(state_)) {
    for (const Step which : {Step::judge_trial, Step::step_length}) program(which, {});
    for (const auto& [columns, rows] : summary_sizes(width, height)) {
        summaries_.emplace_back(GL_RGBA32UI, columns, rows);
        summary_targets_.push_back(Framebuffer({{&summaries_.back()}}));
    }
    summary_ = Program::draw("common/whole.vert", "optimize/summary.frag");
    further_summary_ = Program::draw("common/whole.vert", "optimize/summary.frag", {{"FURTHER", ""}});
}

const Program& ProblemNumbers::program(Step which, const Turn& turn) {
    const int layers = ProblemNumbers::layers(room_) - own_layer;
    Program& program = programs_[{step_key(which, turn), layers}];
    if (!program)
        program = Program::draw("common/whole.vert", "optimize/step.frag",
                                defines_ + step_defines(which, turn) + Defines{{"OWN_LAYERS", std::to_string(layers)}});
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

void ProblemNumbers::write_fresh(std::span<const Status> status) {
    using real = float;  // HUGE_ERROR is text shared with GLSL
    std::vector<float> layers[own_layer];
    for (auto& layer : layers) layer.resize(4 * size_t(state_.width()) * size_t(state_.height()));
    for (size_t at = 0; at < layers[0].size(); at += 4) {
        layers[number::error / 4][at + number::error % 4] = HUGE_ERROR;
        layers[number::step_factor / 4][at + number::step_factor % 4] = 1;
        layers[number::status / 4][at + number::status % 4] = float(Status::no_samples);  // where no problem is, too
    }
    for (size_t i = 0; i < status.size(); ++i)
        layers[number::status / 4][4 * place(i) + number::status % 4] = float(status[i]);
    for (int layer = 0; layer < own_layer; ++layer) state_.upload(GL_RGBA, GL_FLOAT, layers[layer].data(), layer);
}

void ProblemNumbers::step(Step which, const Turn& turn) {
    const Program& step = program(which, turn);
    set_turn(step, turn);
    step.bind("state", state_);
    gl().TextureBarrier();
    run_.draw_whole(target_, step);
    gl().TextureBarrier();
}

std::vector<float> ProblemNumbers::read_places(int layer) const {
    std::vector<float> all(4 * size_t(state_.width()) * size_t(state_.height()));
    state_.download(GL_RGBA, GL_FLOAT, all.data(), all.size() * sizeof(float), layer);
    return all;
}

std::vector<float> ProblemNumbers::read(std::initializer_list<int> numbers) const {
    std::vector<float> out, all;
    int layer = -1;
    for (const int n : numbers) {
        if (n / 4 != layer) all = read_places(layer = n / 4);
        for (size_t i = 0; i < count(); ++i) out.push_back(all[4 * place(i) + size_t(n % 4)]);
    }
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

EngineSummary ProblemNumbers::summary() {
    const Texture* from = &state_;
    for (size_t level = 0; level < summaries_.size(); ++level) {
        const Program& program = level == 0 ? summary_ : further_summary_;
        program.bind("source", *from);
        run_.draw_whole(summary_targets_[level], program, uint64_t(from->width()) * uint64_t(from->height()));
        from = &summaries_[level];
    }
    std::array<std::array<uint32_t, 4>, most_summaries> parts;
    from->download(GL_RGBA_INTEGER, GL_UNSIGNED_INT, parts.data(), sizeof parts);
    return sum_of(std::span(parts).first(size_t(from->width() * from->height())));
}

Program make_update(Update which, const std::string& vertex_file, const std::string& elements, const Defines& defines) {
    return Program::draw(vertex_file, "optimize/update.frag",
                         defines + Defines{{"ELEMENTS", elements}} + update_defines(which));
}

void ProblemNumbers::set_update(const Program& update, const Texture& products, std::initializer_list<int> numbers,
                                std::initializer_list<float> constants) const {
    radiafit::set_update(update, numbers, constants, 4 * own_layer);
    update.bind_if_used("state", state_);
    update.bind_if_used("products", products);
}

}  // namespace radiafit

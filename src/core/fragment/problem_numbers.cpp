#include "fragment/problem_numbers.h"

namespace radiafit {
namespace {

constexpr int most_summaries = 64;

// Of problems or of parts of the sum that a fragment of summary.frag takes.
std::array<int, 2> summary_block(bool first, bool one_target) {
    if (!one_target) return {16, 16};
    return first ? std::array{4, 2} : std::array{4, 4};
}

}  // namespace

ProblemNumbers::ProblemNumbers(PassRunner& run, int width, int height, size_t count, std::vector<uint32_t> place,
                               const std::string& problems, bool one_target)
    : DeviceNumbers(count),
      run_(run),
      place_(std::move(place)),
      defines_{{"PROBLEMS", problems}},
      one_target_(one_target),
      state_(make_state(width, height, own_layer)) {
    if (one_target) next_ = make_state(width, height, own_layer);
    for (const Step which : {Step::judge_trial, Step::step_length}) programs(which, {});
    for (const auto& [columns, rows] : summary_sizes(width, height, one_target)) {
        summaries_.emplace_back(GL_RGBA32UI, columns, rows);
        summary_targets_.push_back(Framebuffer({{&summaries_.back()}}));
    }
    const Defines blocks = one_target ? Defines{{"WHOLE_BLOCKS", ""}} : Defines{};
    summary_ = Program::draw("common/whole.vert", "optimize/summary.frag", blocks);
    further_summary_ = Program::draw("common/whole.vert", "optimize/summary.frag", blocks + Defines{{"FURTHER", ""}});
}

ProblemNumbers::State ProblemNumbers::make_state(int width, int height, int layers) const {
    State state{Texture(GL_RGBA32F, width, height, layers), {}};
    std::vector<Target> all;
    for (int layer = 0; layer < layers; ++layer) all.push_back({&state.numbers, layer});
    state.targets = result_targets(all, one_target_);
    return state;
}

const std::vector<Program>& ProblemNumbers::programs(Step which, const Turn& turn) {
    const int layers = ProblemNumbers::layers(room_), own = layers - own_layer;
    std::vector<Program>& programs = programs_[{step_key(which, turn), own}];
    if (programs.empty())
        for (const Defines& result : result_defines(layers, one_target_))
            programs.push_back(Program::draw(
                "common/whole.vert", "optimize/step.frag",
                defines_ + step_defines(which, turn) + Defines{{"OWN_LAYERS", std::to_string(own)}} + result));
    return programs;
}

void ProblemNumbers::make_room(const Room& room) {
    const int layers = ProblemNumbers::layers(room), width = state_.numbers.width(), height = state_.numbers.height();
    if (layers != state_.numbers.layers()) {
        State grown = make_state(width, height, layers);
        for (int layer = 0; layer < own_layer; ++layer)
            grown.numbers.upload(GL_RGBA, GL_FLOAT, read_places(layer).data(), layer);
        state_ = std::move(grown);
        if (one_target_) next_ = make_state(width, height, layers);
    }
    room_ = room;
    const std::vector<float> zero(4 * size_t(width) * size_t(height));
    for (int layer = own_layer; layer < layers; ++layer) state_.numbers.upload(GL_RGBA, GL_FLOAT, zero.data(), layer);
}

void ProblemNumbers::write_fresh(std::span<const Status> status) {
    using real = float;  // HUGE_ERROR is text shared with GLSL
    std::vector<float> layers[own_layer];
    for (auto& layer : layers) layer.resize(4 * size_t(state_.numbers.width()) * size_t(state_.numbers.height()));
    for (size_t at = 0; at < layers[0].size(); at += 4) {
        layers[number::error / 4][at + number::error % 4] = HUGE_ERROR;
        layers[number::step_factor / 4][at + number::step_factor % 4] = 1;
        layers[number::status / 4][at + number::status % 4] = float(Status::no_samples);  // where no problem is, too
    }
    for (size_t i = 0; i < status.size(); ++i)
        layers[number::status / 4][4 * place(i) + number::status % 4] = float(status[i]);
    for (int layer = 0; layer < own_layer; ++layer)
        state_.numbers.upload(GL_RGBA, GL_FLOAT, layers[layer].data(), layer);
}

void ProblemNumbers::step(Step which, const Turn& turn) {
    const std::vector<Program>& steps = programs(which, turn);
    const State& to = one_target_ ? next_ : state_;
    gl().TextureBarrier();
    for (size_t i = 0; i < steps.size(); ++i) {
        set_turn(steps[i], turn);
        steps[i].bind("state", state_.numbers);
        run_.draw_whole(to.targets[i], steps[i]);
    }
    if (one_target_) std::swap(state_, next_);
    gl().TextureBarrier();
}

std::vector<float> ProblemNumbers::read_places(int layer) const {
    std::vector<float> all(4 * size_t(state_.numbers.width()) * size_t(state_.numbers.height()));
    state_.numbers.download(GL_RGBA, GL_FLOAT, all.data(), all.size() * sizeof(float), layer);
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

std::vector<std::array<int, 2>> ProblemNumbers::summary_sizes(int width, int height, bool one_target) {
    std::vector<std::array<int, 2>> sizes;
    do {
        const auto [columns, rows] = summary_block(sizes.empty(), one_target);
        width = (width + columns - 1) / columns, height = (height + rows - 1) / rows;
        sizes.push_back({width, height});
    } while (width * height > most_summaries);
    return sizes;
}

uint64_t ProblemNumbers::summary_texels(int width, int height, bool one_target) {
    uint64_t texels = 0;
    for (const auto& [columns, rows] : summary_sizes(width, height, one_target))
        texels += uint64_t(columns) * uint64_t(rows);
    return texels;
}

EngineSummary ProblemNumbers::summary() {
    const Texture* from = &state_.numbers;
    for (size_t level = 0; level < summaries_.size(); ++level) {
        const Program& program = level == 0 ? summary_ : further_summary_;
        program.bind("source", *from);
        run_.draw_whole(summary_targets_[level], program,
                        one_target_ ? 0 : uint64_t(from->width()) * uint64_t(from->height()));
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
    update.bind_if_used("state", state_.numbers);
    update.bind_if_used("products", products);
}

}  // namespace radiafit

#include "compute/buffer_engine.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "base/error.h"

namespace radiafit {
namespace {

constexpr size_t block = 256;                  // problems that one invocation of summary.comp looks at
constexpr int most_blocks = MOST_VECTORS + 3;  // storage blocks of a pass: an update's vectors, numbers, products, sums

/// `problems`, where the device's passes may have enough storage blocks. Throws UserError otherwise.
size_t on_this_device(size_t problems) {
    const Context& context = Context::current();
    if (context.limits().compute_ssbos < most_blocks)
        throw UserError(
            fmt::format("{} lets a compute shader have {} storage blocks, and {} are needed; choose another "
                        "engine",
                        context.renderer(), context.limits().compute_ssbos, most_blocks));
    return problems;
}

void check_size(const char* what, uint64_t bytes, uint64_t most) {
    if (bytes > most)
        throw UserError(fmt::format("{} take {} MB, and {} allows {} MB; choose another engine, or a smaller fit", what,
                                    bytes / 1000000 + 1, Context::current().renderer(), most / 1000000));
}

}  // namespace

FetchedBuffer::FetchedBuffer(const char* what, GLenum format, size_t bytes, const void* data) {
    check_size(what, bytes,
               uint64_t(Context::current().limits().texture_buffer_texels) * uint64_t(bytes_per_texel(format)));
    buffer = Buffer(bytes, data);
    texture = Texture::of_buffer(format, buffer);
}

FetchedBuffer FetchedBuffer::written(const char* what, size_t texels, GLenum format) {
    const auto each = uint64_t(bytes_per_texel(format));
    check_size(what, texels * each, uint64_t(Context::current().limits().texture_buffer_texels) * each);
    FetchedBuffer out;
    out.buffer = storage_buffer(what, texels * each);
    out.texture = Texture::of_buffer(format, out.buffer);
    return out;
}
Buffer storage_buffer(const char* what, size_t bytes) {
    check_size(what, bytes, uint64_t(Context::current().limits().ssbo_bytes));
    Buffer buffer(bytes, nullptr, true);
    buffer.clear();
    return buffer;
}

ProblemBuffers::ProblemBuffers(size_t problems, const std::string& given, size_t shared_bytes_each, size_t items)
    : DeviceNumbers(on_this_device(problems)),
      tried_groups_(group_size_is_open() ? group_trial(items) : std::vector<TriedGroup>()),
      lanes_(Context::current().group_size(tried_groups_.empty() ? 32 : best_group(tried_groups_), shared_bytes_each)),
      given_text_(given),
      numbers_(storage_buffer("numbers of problems", problems * number_count * sizeof(float))),
      summaries_(storage_buffer("summaries", (problems + block - 1) / block * 16)),
      summary_(Program::compute("compute/summary.comp", defines() + Defines{{"BLOCK", std::to_string(block)}})) {
    bind_to(summary_);
    summary_.bind("Summaries", summaries_);
}

void ProblemBuffers::make_products(int count, size_t bytes_each) {
    if (product_count_ == count) return;
    product_count_ = count;
    products_ = storage_buffer("products", size_t(count) * bytes_each);
}

Defines ProblemBuffers::defines() const {
    return {{"LANES", std::to_string(lanes_)},
            {"NUMBER_COUNT", std::to_string(number_count)},
            {"NUMBER_STATUS", std::to_string(number::status)},
            {"NUMBER_ACCEPTED", std::to_string(number::accepted)},
            {"NUMBER_FIRST_OWN", std::to_string(int(number::first_own))}};
}

void ProblemBuffers::bind_to(const Program& program) const {
    program.bind_if_used("Numbers", numbers_);
    program.bind_if_used("Problems", given_);
    program.bind_if_used("Products", products_);
    program.set_if_used("product_count", product_count_);
    program.set_if_used("problem_count", int(count()));
}

void ProblemBuffers::write_fresh(std::span<const Status> status) {
    using real = float;  // HUGE_ERROR is text shared with GLSL
    std::vector<float> numbers(count() * number_count);
    for (size_t i = 0; i < count(); ++i) {
        float* of = &numbers[i * number_count];
        of[number::error] = HUGE_ERROR;
        of[number::step_factor] = 1;
        of[number::status] = float(status[i]);
    }
    numbers_.write(0, numbers.size() * sizeof(float), numbers.data());
    optimizer_clear_ = true;
}

void ProblemBuffers::make_room(const Room&) {
    if (optimizer_clear_) return;
    optimizer_clear_ = true;
    std::vector<float> numbers = read_all();
    for (size_t i = 0; i < count(); ++i)
        std::fill_n(&numbers[i * number_count + number::first_own], number_count - number::first_own, 0.0f);
    numbers_.write(0, numbers.size() * sizeof(float), numbers.data());
}

const Program& ProblemBuffers::program(Step which, const Turn& turn) {
    Program& step = steps_[step_key(which, turn)];
    if (!step)
        step = Program::compute("compute/step.comp",
                                defines() + Defines{{"PROBLEMS", given_text_}} + step_defines(which, turn));
    return step;
}

void ProblemBuffers::step(Step which, const Turn& turn) {
    const Program& step = program(which, turn);
    optimizer_clear_ = false;
    bind_to(step);
    set_turn(step, turn);
    step.dispatch(groups(count()));
}

EngineSummary ProblemBuffers::summary() {
    const size_t blocks = (count() + block - 1) / block;
    summary_.dispatch(groups(blocks));
    std::vector<std::array<uint32_t, 4>> parts(blocks);
    summaries_.read(0, blocks * sizeof parts[0], parts.data());
    return sum_of(parts);
}

std::vector<float> ProblemBuffers::read_all() const {
    std::vector<float> all(count() * number_count);
    numbers_.read(0, all.size() * sizeof(float), all.data());
    return all;
}

std::vector<float> ProblemBuffers::read(std::initializer_list<int> numbers) const {
    const std::vector<float> all = read_all();
    std::vector<float> out;
    for (const int n : numbers)
        for (size_t i = 0; i < count(); ++i) out.push_back(all[i * number_count + size_t(n)]);
    return out;
}

// body(index in Parameters order, index in the buffer) for all parameters of texels.
template <class Body>
void BufferVector::for_parameters(const Body& body) const {
    const size_t texels = texels_->texels(), each = size_t(texels_->model->parameters);
    for (size_t texel = 0; texel < texels; ++texel)
        for (size_t i = 0; i < each; ++i) {
            const auto [map, channel] = TexelShape::map_of(int(i));
            body(texel * each + i, 4 * (size_t(map) * texels + texel) + size_t(channel));
        }
}

void BufferVector::upload(std::span<const float> values) {
    if (!texels_) return buffer.write(0, values.size_bytes(), values.data());
    std::vector<float> all(buffer.bytes() / sizeof(float));
    for_parameters([&](size_t i, size_t at) { all[at] = values[i]; });
    buffer.write(0, buffer.bytes(), all.data());
}

void BufferVector::download(std::span<float> values) const {
    if (!texels_) return buffer.read(0, values.size_bytes(), values.data());
    std::vector<float> all(buffer.bytes() / sizeof(float));
    buffer.read(0, buffer.bytes(), all.data());
    for_parameters([&](size_t i, size_t at) { values[i] = all[at]; });
}

ProblemBuffers& BufferEngine::make(const Arrays& arrays) {
    arrays_ = arrays;
    numbers_ =
        std::make_unique<ProblemBuffers>(arrays.problem_count, arrays.problems, arrays.shared_bytes_each, arrays.items);
    numbers_->make_given(arrays.given_bytes);
    make_room({});
    return *numbers_;
}

void BufferEngine::compile(const std::string& prefix, size_t groups) {
    prefix_ = prefix;
    groups_ = groups;
    dot_ = program(prefix_ + "dot.comp", {});
    for (const Step which : {Step::judge_trial, Step::step_length}) numbers_->program(which, {});
    for (const Update which : {Update::update_direction, Update::advance}) update_program(which);
}

void BufferEngine::dot(std::initializer_list<DotProduct> products) {
    numbers_->bind_to(dot_);
    for (const DotProduct& product : products) {
        const bool weighted = product.weight != vector::none;
        dot_.bind("left", vectors_[size_t(product.a)].texture);
        dot_.bind("right", vectors_[size_t(product.b)].texture);
        dot_.bind("weights", vectors_[size_t(weighted ? product.weight : product.a)].texture);
        dot_.set("weighted", int(weighted));
        dot_.set("product", product.into);
        dot_.dispatch(groups_);
    }
}

const Program& BufferEngine::update_program(Update which) {
    Program& made = updates_[which];
    if (!made) made = program(prefix_ + "update.comp", update_defines(which));
    return made;
}

void BufferEngine::update(Update which, std::initializer_list<int> vectors, std::initializer_list<int> numbers,
                          std::initializer_list<float> constants) {
    const Program& update = update_program(which);
    for (size_t k = 0; k < vectors.size(); ++k)
        update.bind_if_used("Vectors[" + std::to_string(k) + "]", vectors_[size_t(std::data(vectors)[k])].buffer);
    set_update(update, numbers, constants, number::first_own);
    numbers_->bind_to(update);
    update.dispatch(groups_);
}

}  // namespace radiafit

#include "compute/buffer_engine.h"

namespace radiafit {

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
    numbers_ = std::make_unique<ProblemBuffers>(arrays.problem_count, arrays.problems);
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

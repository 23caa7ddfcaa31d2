#include "batch/array_folder.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "base/error.h"
#include "base/read_file.h"

namespace radiafit::batch {

template <class real>
ArrayFolder<real>::ArrayFolder(const std::filesystem::path& folder, const ModelText& model)
    : folder_(folder), names_(model.terms), values_(model.values.size()) {
    if (path_exists(folder_ / "problems.json"))
        open_texels(model);
    else
        open(model);
}

template <class real>
void ArrayFolder<real>::open(const ModelText& model) {
    const auto file = [&](const char* name) { return folder_ / fmt::format("{}.npy", name); };
    const auto open_if_there = [&](const char* name, std::optional<ArrayFile<real>>& array) {
        if (path_exists(file(name))) array.emplace(file(name), name);
    };
    terms_.emplace_back(file("terms"), "terms");
    targets_.emplace(file("targets"), "targets");
    open_if_there("weights", weights_);
    open_if_there("start", starts_);
    ProblemArrays<real> shapes{.terms = terms_[0].shape(), .targets = targets_->shape()};
    if (weights_) shapes.weights = weights_->shape();
    if (starts_) shapes.starts = starts_->shape();
    if (path_exists(file("offsets"))) {
        const NpyReader array(file("offsets"), "offsets");
        offsets_ = array.read<int64_t>();
        offsets_file_ = array.file();
        shapes.offsets = {array.file(), array.shape(), offsets_};
    }
    arrange(model, shapes);
    shared_terms_ = offsets_.empty() && terms_[0].size() == all_.samples * names_.size();
}

/// Texels as `export problems` writes them: the model's terms are among u_x to v_z, of the directions to lamp and
/// camera.
template <class real>
void ArrayFolder<real>::open_texels(const ModelText& model) {
    static const std::vector<std::string> known = {"u_x", "u_y", "u_z", "v_x", "v_y", "v_z"};
    const auto file = [&](const std::string& name) { return folder_ / fmt::format("training_{}.npy", name); };
    const std::string what = "array of a texel-local model's problems";
    terms_.emplace_back(file("u"), what);
    terms_.emplace_back(file("v"), what);
    targets_.emplace(file("target"), what);
    weights_.emplace(file("weight"), what);
    const NpyReader first(file("first"), what);
    offsets_ = first.read<int64_t>();
    offsets_file_ = first.file();
    if (terms_[0].size() != terms_[1].size())
        throw UserError(fmt::format("{}: not as long as {}", terms_[1].name(), terms_[0].name()));
    for (const std::string& name : names_) {
        columns_.push_back(size_t(std::ranges::find(known, name) - known.begin()));
        if (columns_.back() == known.size())
            throw UserError(
                fmt::format("{}: has no term '{}'; there are: {}", folder_.string(), name, fmt::join(known, ", ")));
    }
    const ProblemArrays<real> shapes{.terms = {terms_[0].name(), {terms_[0].size() / 3, names_.size()}, {}},
                                     .targets = targets_->shape(),
                                     .weights = weights_->shape(),
                                     .offsets = ShapedArray<int64_t>{first.file(), first.shape(), offsets_}};
    arrange(model, shapes);
}

template <class real>
void ArrayFolder<real>::arrange(const ModelText& model, const ProblemArrays<real>& shapes) {
    all_ = arranged(model, shapes);
    if (!offsets_.empty()) check_offsets(offsets_, offsets_file_.string());
}

template <class real>
uint64_t ArrayFolder<real>::begin_of(size_t problem) const {
    return offsets_.empty() ? uint64_t(problem) * all_.samples : uint64_t(offsets_[problem]);
}

template <class real>
void ArrayFolder<real>::read_terms(uint64_t first, uint64_t samples, std::vector<real>& to) const {
    if (shared_terms_) return terms_[0].append(0, terms_[0].size(), to);
    if (columns_.empty()) return terms_[0].append(first * names_.size(), samples * names_.size(), to);
    std::vector<real> directions[2];
    for (size_t i = 0; i < 2; ++i) terms_[i].append(3 * first, 3 * samples, directions[i]);
    for (size_t s = 0; s < samples; ++s)
        for (const size_t column : columns_) to.push_back(directions[column / 3][3 * s + column % 3]);
}

template <class real>
void ArrayFolder<real>::read_targets(uint64_t first, uint64_t samples, std::vector<real>& to) const {
    targets_->append(first * values_, samples * values_, to);
}

template <class real>
void ArrayFolder<real>::read_weights(uint64_t first, uint64_t samples, std::vector<real>& to) const {
    if (!weights_) return;
    weights_->append(first, samples, to);
    check_weights<real>(to, weights_->name());
}

template <class real>
void ArrayFolder<real>::read_starts(size_t first, size_t count, std::vector<real>& to) const {
    if (!starts_) return;
    const size_t parameters = starts_->shape().shape.back();
    const bool one = starts_->size() == all_.start_count * parameters;
    for (size_t start = 0; start < all_.start_count; ++start)
        starts_->append((start * (one ? 1 : all_.count) + (one ? 0 : first)) * parameters,
                        (one ? 1 : count) * parameters, to);
}

template <class real>
uint64_t ArrayFolder<real>::numbers_of_starts(size_t problems) const {
    if (!starts_) return 0;
    const uint64_t common = all_.start_count * starts_->shape().shape.back();
    return starts_->size() == common ? common : common * problems;
}

template <class real>
std::vector<const ArrayFile<real>*> ArrayFolder<real>::arrays() const {
    std::vector<const ArrayFile<real>*> out;
    for (const auto& array : terms_) out.push_back(&array);
    for (const auto* array : {&targets_, &weights_, &starts_})
        if (*array) out.push_back(&**array);
    return out;
}

template <class real>
uint64_t ArrayFolder<real>::held_bytes() const {
    uint64_t out = offsets_.size() * sizeof(int64_t);
    for (const auto* array : arrays()) out += array->held_bytes();
    return out;
}

template <class real>
uint64_t ArrayFolder<real>::numbers_of_sample() const {
    return (shared_terms_ ? 0 : names_.size()) + values_ + (weights_ ? 1 : 0) + (columns_.empty() ? 0 : 6);
}

template <class real>
std::vector<std::filesystem::path> ArrayFolder<real>::files() const {
    std::vector<std::filesystem::path> out;
    for (const auto* array : arrays()) out.emplace_back(array->name());
    if (!offsets_file_.empty()) out.push_back(offsets_file_);
    return out;
}

template class ArrayFolder<float>;
template class ArrayFolder<double>;

}  // namespace radiafit::batch

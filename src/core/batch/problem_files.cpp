#include "batch/problem_files.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/read_file.h"
#include "base/wording.h"
#include "batch/array_folder.h"
#include "batch/problem_table.h"

namespace radiafit::batch {

using std::filesystem::path;

template <class real>
ProblemFiles<real>::ProblemFiles(const path& input, const ModelText& model, const ByName& start)
    : input_(input), given_(of_parameters(model, "start", start, std::numeric_limits<double>::quiet_NaN())) {
    if (!path_exists(input)) throw UserError(input.string() + ": no such file or folder");
    if (folder_exists(input))
        arrays_ = std::make_unique<ArrayFolder<real>>(input, model);
    else
        table_ = read_problem_table<real>(input, model);
    numbers_of_sample_ = arrays_ ? arrays_->numbers_of_sample()
                                 : model.terms.size() + model.values.size() + (table_.weights.empty() ? 0 : 1);
    const uint64_t p = given_.size(),
                   of_each = (p + 2) * (p + 2) + numbers_of_sample_;  // that a problem and its solution have
    if (uint64_t(count()) > (uint64_t(1) << 58) / of_each)
        throw UserError(fmt::format("{}: {} problems, more than any disk holds solutions of", input.string(), count()));
    std::vector<real> common;
    if (arrays_ && arrays_->starts() && arrays_->starts()->size() != given_.size()) return;
    if (arrays_) arrays_->read_starts(0, 1, common);
    common.resize(given_.size(), std::numeric_limits<real>::quiet_NaN());
    std::vector<std::string> missing;
    for (size_t i = 0; i < given_.size(); ++i)
        if (std::isnan(given_[i]) && std::isnan(common[i])) missing.push_back(model.parameters[i]);
    if (missing.empty()) return;
    const std::string names = fmt::format("{}", fmt::join(missing, ", "));
    const std::string values = fmt::format("{}=VALUE", fmt::join(missing, "=VALUE,"));
    throw UserError(fmt::format("{}: says not where fits begin in {}; {}", input.string(), names,
                                at_command_line("give --start " + values, "give starts")));
}

template <class real>
ProblemFiles<real>::~ProblemFiles() = default;

template <class real>
size_t ProblemFiles<real>::count() const {
    return arrays_ ? arrays_->count() : table_.count;
}

template <class real>
const std::vector<std::string>& ProblemFiles<real>::labels() const {
    return table_.labels;
}

template <class real>
std::vector<path> ProblemFiles<real>::files() const {
    return arrays_ ? arrays_->files() : std::vector{input_};
}

template <class real>
uint64_t ProblemFiles<real>::held_bytes() const {
    return arrays_ ? arrays_->held_bytes() : bytes(0, count());
}

template <class real>
uint64_t ProblemFiles<real>::bytes(size_t first, size_t count) const {
    const uint64_t samples = arrays_ ? arrays_->begin_of(first + count) - arrays_->begin_of(first)
                                     : uint64_t(table_.offsets[first + count] - table_.offsets[first]);
    const uint64_t starts = std::max<uint64_t>(given_.size(), arrays_ ? arrays_->numbers_of_starts(count) : 0);
    return (samples * numbers_of_sample_ + starts) * sizeof(real) + (count + 1) * sizeof(int64_t);
}

template <class real>
StoredProblems<real> ProblemFiles<real>::read(size_t first, size_t count) const {
    StoredProblems<real> out;
    out.count = count;
    out.first = first;
    const std::vector<int64_t>& offsets = arrays_ ? arrays_->offsets() : table_.offsets;
    if (!offsets.empty())
        for (size_t i = first; i <= first + count; ++i) out.offsets.push_back(offsets[i] - offsets[first]);
    if (arrays_) {
        const uint64_t begin = arrays_->begin_of(first), samples = arrays_->begin_of(first + count) - begin;
        out.samples = arrays_->samples();
        out.start_count = arrays_->start_count();
        arrays_->read_terms(begin, samples, out.terms);
        arrays_->read_targets(begin, samples, out.targets);
        arrays_->read_weights(begin, samples, out.weights);
        arrays_->read_starts(first, count, out.starts);
    } else {
        const auto part = [&](const std::vector<real>& all, std::vector<real>& to) {
            const size_t of_each = all.size() / size_t(table_.offsets.back());
            to.assign(all.begin() + ptrdiff_t(size_t(offsets[first]) * of_each),
                      all.begin() + ptrdiff_t(size_t(offsets[first + count]) * of_each));
        };
        part(table_.terms, out.terms);
        part(table_.targets, out.targets);
        part(table_.weights, out.weights);
        out.labels.assign(table_.labels.begin() + ptrdiff_t(first), table_.labels.begin() + ptrdiff_t(first + count));
    }
    if (out.starts.empty()) out.starts.resize(given_.size());
    for (size_t i = 0; i < out.starts.size(); ++i)
        if (const double x = given_[i % given_.size()]; !std::isnan(x)) out.starts[i] = real(x);
    return out;
}

template class ProblemFiles<float>;
template class ProblemFiles<double>;

}  // namespace radiafit::batch

#include "batch/arrange.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"

namespace radiafit::batch {
namespace {

using Shape = std::vector<uint64_t>;

std::string text_of(const Shape& shape) {
    return fmt::format("({}{})", fmt::join(shape, ", "), shape.size() == 1 ? "," : "");
}

/// The shape without the last index, of which there are so many; where it is one alone, it may be left out.
std::optional<Shape> without_last(const Shape& shape, uint64_t last, size_t dimensions) {
    if (shape.size() == dimensions + 1 && shape.back() == last) return Shape(shape.begin(), shape.end() - 1);
    if (shape.size() == dimensions && last == 1) return shape;
    return std::nullopt;
}

template <class Number>
[[noreturn]] void reject(const ShapedArray<Number>& array, const std::string& wanted) {
    throw UserError(fmt::format("{}: its shape is {}, which should be {}", array.name, text_of(array.shape), wanted));
}

std::string with_last(const std::string& samples, const std::vector<std::string>& names) {
    return fmt::format("({}, {}), the last one for {}", samples, names.size(), fmt::join(names, ", "));
}

}  // namespace

template <class real>
Problems<real> arranged(const ModelText& model, const ProblemArrays<real>& arrays) {
    Problems<real> out;
    const bool ragged = arrays.offsets.has_value();
    if (ragged) {
        if (arrays.offsets->shape.size() != 1 || arrays.offsets->shape[0] == 0)
            reject(*arrays.offsets, "(problems + 1,)");
        out.offsets = arrays.offsets->numbers;
        out.count = out.offsets.size() - 1;
    }
    const size_t dimensions = ragged ? 1 : 2;
    const auto samples = without_last(arrays.targets.shape, model.values.size(), dimensions);
    if (!samples)
        reject(arrays.targets, with_last(ragged ? "all samples" : "problems, samples", model.values) +
                                   (ragged ? "" : "; problems of several lengths need offsets"));
    const std::string found = fmt::format("{}", fmt::join(*samples, ", "));
    if (ragged && (*samples)[0] != uint64_t(out.offsets.back()))
        throw UserError(fmt::format("{}: ends with {}, where {} has {} samples", arrays.offsets->name,
                                    out.offsets.back(), arrays.targets.name, (*samples)[0]));
    if (!ragged) {
        out.count = (*samples)[0];
        out.samples = (*samples)[1];
    }
    out.targets = arrays.targets.numbers;

    const Shape& terms = arrays.terms.shape;
    const uint64_t term_count = model.terms.size();
    const bool own = without_last(terms, term_count, dimensions) == samples;
    const bool shared = !ragged && without_last(terms, term_count, 1) == Shape{out.samples};
    if (!own && !shared)
        reject(arrays.terms,
               (ragged ? "" : fmt::format("({}, {}) or ", out.samples, term_count)) + with_last(found, model.terms));
    out.terms = arrays.terms.numbers;

    if (arrays.weights) {
        if (arrays.weights->shape != *samples) reject(*arrays.weights, text_of(*samples));
        out.weights = arrays.weights->numbers;
    }
    if (arrays.starts) {
        const Shape& shape = arrays.starts->shape;
        const uint64_t parameters = model.parameters.size();
        const bool fits =
            shape == Shape{parameters} || shape == Shape{out.count, parameters} ||
            (shape.size() == 3 && shape[0] > 0 && (shape[1] == 1 || shape[1] == out.count) && shape[2] == parameters);
        if (!fits)
            reject(*arrays.starts,
                   fmt::format("({1},), ({0}, {1}), or of several starts (starts, {0} or 1, {1}), for {2}", out.count,
                               parameters, fmt::join(model.parameters, ", ")));
        out.starts = arrays.starts->numbers;
        out.start_count = shape.size() == 3 ? shape[0] : 1;
    }
    return out;
}

template Problems<float> arranged(const ModelText&, const ProblemArrays<float>&);
template Problems<double> arranged(const ModelText&, const ProblemArrays<double>&);

}  // namespace radiafit::batch

#pragma once
#include <optional>
#include <string>

#include "batch/problems.h"

namespace radiafit::batch {

/// An array of a file or a caller: its name in messages, how many of each index it has, and its numbers.
template <class Number>
struct ShapedArray {
    std::string name;
    std::vector<uint64_t> shape;
    std::span<const Number> numbers;
};

/// With offsets the others have one index over all samples in place of [problems, samples].
template <class real>
struct ProblemArrays {
    ShapedArray<real> terms;    ///< [problems, samples, terms], or [samples, terms] where all problems have the same
    ShapedArray<real> targets;  ///< [problems, samples, values]
    std::optional<ShapedArray<real>> weights = {};     ///< [problems, samples]
    std::optional<ShapedArray<int64_t>> offsets = {};  ///< [problems + 1]
    /// [parameters], [problems, parameters], or of several starts [starts, problems or 1, parameters].
    std::optional<ShapedArray<real>> starts = {};
};

/// The problems that arrays of these shapes hold; an index that runs over one alone, such as the only value, may be
/// left out. Throws UserError that names the array and the shape that it should have.
template <class real>
Problems<real> arranged(const ModelText& model, const ProblemArrays<real>& arrays);

}  // namespace radiafit::batch

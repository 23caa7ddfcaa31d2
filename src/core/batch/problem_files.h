#pragma once
#include <filesystem>
#include <string>

#include "batch/problems.h"

namespace radiafit::batch {

/// Problems as files have them, and where fits begin.
template <class real>
struct StoredProblems {
    size_t count = 0;
    std::vector<int64_t> offsets;  ///< empty: each problem has `samples`
    size_t samples = 0;
    std::vector<real> terms, targets, weights, starts;
    size_t start_count = 1;
    std::vector<std::string> labels;  ///< [count] of a table's problems; empty: they have numbers

    Problems<real> arrays() const { return {count, offsets, samples, terms, targets, weights, starts, start_count}; }
};

/// Of a folder: terms.npy, targets.npy, and where there are any weights.npy, offsets.npy, start.npy (docs/solve.md). Of
/// a folder that `export problems` wrote of texels: these, the terms being named u_x, u_y, u_z (to the lamp), v_x, v_y,
/// v_z (to the camera). Of another file: a table (CSV) whose first line names its columns: the model's terms and
/// values, and `weight` and `problem`, by whose value rows belong together. start: in place of what start.npy says, and
/// for all parameters where there is none. Throws UserError that names the file and the cure.
template <class real>
StoredProblems<real> read_problems(const std::filesystem::path& input, const ModelText& model, const ByName& start);

}  // namespace radiafit::batch

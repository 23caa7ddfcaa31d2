#pragma once
#include <filesystem>
#include <memory>
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

    size_t first = 0;  ///< of the first of them among all

    Problems<real> arrays() const {
        return {count, offsets, samples, terms, targets, weights, starts, start_count, first};
    }
};

template <class real>
class ArrayFolder;

/// The problems of a folder or a table, which reads them some at a time. Of a folder: terms.npy, targets.npy, and where
/// there are any weights.npy, offsets.npy, start.npy (docs/solve.md). Of a folder that `export problems` wrote of
/// texels: these, the terms being named u_x, u_y, u_z (to the lamp), v_x, v_y, v_z (to the camera). Of another file: a
/// table (CSV), which is held as a whole, whose first line names its columns: the model's terms and values, and
/// `weight` and `problem`, by whose value rows belong together.
template <class real>
class ProblemFiles {
public:
    /// start: in place of what start.npy says, and for all parameters where there is none. Throws UserError that names
    /// the file and the cure; of numbers in arrays read() does.
    ProblemFiles(const std::filesystem::path& input, const ModelText& model, const ByName& start);
    ~ProblemFiles();

    size_t count() const;
    const std::vector<std::string>& labels() const;    ///< as StoredProblems has them, of all
    std::vector<std::filesystem::path> files() const;  ///< that are read
    uint64_t held_bytes() const;                       ///< of memory, whatever is read
    /// Bytes that so many problems from one on take when they are read.
    uint64_t bytes(size_t first, size_t count) const;
    StoredProblems<real> read(size_t first, size_t count) const;

private:
    std::unique_ptr<ArrayFolder<real>> arrays_;  ///< null: of a table
    std::filesystem::path input_;
    StoredProblems<real> table_;
    std::vector<double> given_;  ///< [parameters] starts; NaN: as the files say
    uint64_t numbers_of_sample_ = 0;
};

extern template class ProblemFiles<float>;
extern template class ProblemFiles<double>;

}  // namespace radiafit::batch

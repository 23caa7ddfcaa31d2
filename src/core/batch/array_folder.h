#pragma once
#include <deque>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/npy_file.h"
#include "batch/arrange.h"

namespace radiafit::batch {

/// An array's numbers, some at a time; one whose first index runs fastest is held as a whole.
template <class Number>
class ArrayFile {
public:
    explicit ArrayFile(const std::filesystem::path& file, const std::string& what) : file_(file, what) {
        if (file_.first_index_fastest()) whole_ = file_.template read<Number>();
    }

    ShapedArray<Number> shape() const { return {file_.file(), file_.shape(), {}}; }
    const std::string& name() const { return file_.file(); }
    uint64_t size() const { return file_.elements(); }
    uint64_t held_bytes() const { return whole_.size() * sizeof(Number); }
    /// Behind what is there already.
    void append(uint64_t first, uint64_t count, std::vector<Number>& to) const {
        if (file_.first_index_fastest()) {
            to.insert(to.end(), whole_.begin() + ptrdiff_t(first), whole_.begin() + ptrdiff_t(first + count));
        } else if (to.empty()) {
            to = file_.template read<Number>(first, count);
        } else {
            const std::vector<Number> numbers = file_.template read<Number>(first, count);
            to.insert(to.end(), numbers.begin(), numbers.end());
        }
    }

private:
    NpyReader file_;
    std::vector<Number> whole_;
};

/// The arrays of a folder of problems (problem_files.h), of which only what is needed is read.
template <class real>
class ArrayFolder {
public:
    /// Throws UserError that names the file and the cure.
    ArrayFolder(const std::filesystem::path& folder, const ModelText& model);

    size_t count() const { return all_.count; }
    size_t samples() const { return all_.samples; }  ///< of each problem, without offsets
    size_t start_count() const { return all_.start_count; }
    uint64_t numbers_of_starts(size_t problems) const;  ///< that read_starts() reads of so many
    const std::vector<int64_t>& offsets() const { return offsets_; }
    const std::optional<ArrayFile<real>>& starts() const { return starts_; }
    uint64_t begin_of(size_t problem) const;  ///< where its samples begin among all
    uint64_t held_bytes() const;
    uint64_t numbers_of_sample() const;  ///< that reading it takes, at most
    std::vector<std::filesystem::path> files() const;

    void read_terms(uint64_t first_sample, uint64_t samples, std::vector<real>& to) const;
    void read_targets(uint64_t first_sample, uint64_t samples, std::vector<real>& to) const;
    void read_weights(uint64_t first_sample, uint64_t samples, std::vector<real>& to) const;
    /// The start that all problems have in common, or those of these problems.
    void read_starts(size_t first, size_t count, std::vector<real>& to) const;

private:
    void open(const ModelText& model);
    void open_texels(const ModelText& model);
    void arrange(const ModelText& model, const ProblemArrays<real>& shapes);
    std::vector<const ArrayFile<real>*> arrays() const;

    const std::filesystem::path folder_;
    const std::vector<std::string> names_;  ///< of the model's terms
    const size_t values_;
    std::deque<ArrayFile<real>> terms_;  ///< one; of texels two of three columns each, of directions
    std::vector<size_t> columns_;        ///< of texels: of each term among both arrays'
    std::optional<ArrayFile<real>> targets_, weights_, starts_;
    std::vector<int64_t> offsets_;
    std::filesystem::path offsets_file_;
    Problems<real> all_;  ///< how many there are; no numbers
    bool shared_terms_ = false;
};

extern template class ArrayFolder<float>;
extern template class ArrayFolder<double>;

}  // namespace radiafit::batch

#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/npy_file.h"
#include "base/record.h"
#include "base/rings.h"
#include "batch/problems.h"
#include "fitting/parts/parts.h"
#include "fitting/problem_folder.h"
#include "report/csv.h"

/// What `solve` leaves (docs/solve.md).
namespace radiafit::tools {

inline constexpr const char* solution_json_name = "solution.json";

/// What is said of a solution, or of a shard of one, beside its arrays.
struct SolutionNote {
    batch::ModelText model;
    batch::Precision precision = batch::Precision::double_precision;
    size_t problems = 0;
    bool labelled = false;  ///< of a table: solution.csv names the problems
    double seconds = 0;
    std::optional<Shard> shard = {};
    std::string key = {};               ///< of a shard: what decides all of them
    std::vector<size_t> statuses = {};  ///< how many problems ended how
};

/// A solution that is written some problems at a time, and appears whole or not at all.
template <class real>
class SolutionFolder {
public:
    SolutionFolder(const std::filesystem::path& target, const SolutionNote& note);
    /// The next problems; labels: of a table's.
    void add(const batch::Solution<real>& solution, const std::vector<std::string>& labels);
    void commit(const SolutionNote& note, const Record& record);

private:
    ProblemFolder folder_;
    NpyFile<real> parameters_, sigma_, covariance_, chi2_;
    NpyFile<int32_t> status_, iterations_;
    NpyFile<int64_t> samples_;
    std::optional<harness::CsvWriter> table_;
    std::vector<std::string> names_;
};

/// Bytes that the arrays of a solution take, of each problem.
uint64_t solution_bytes(const SolutionNote& note);

/// What solution.json says of a shard. Throws UserError for a folder that holds none, or a whole solution, or is
/// damaged.
SolutionNote read_solution_shard(const std::filesystem::path& folder);

/// Puts shards together; a shard at a time is held. Throws UserError naming those that are missing, foreign or there
/// twice.
SolutionNote merge_solutions(const std::vector<std::filesystem::path>& shards, const std::filesystem::path& target,
                             const Record& record);

/// How many ended how, for people or as JSON.
void print_solution(const SolutionNote& note, bool json);

/// {"converged": 12, ...}: how many ended how.
std::string statuses_json(const std::vector<size_t>& counts);

}  // namespace radiafit::tools

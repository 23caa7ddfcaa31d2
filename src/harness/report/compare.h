#pragma once
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/statistics.h"
#include "report/columns.h"
#include "report/finished_runs.h"

/// Two runs of an experiment, figure by figure: what differs, what got slower, and what cannot be decided
/// (docs/compare.md).
namespace radiafit::harness {

enum class Verdict { different, slower, missing, added, faster, unclear, same };
const char* to_string(Verdict verdict);  ///< "DIFFERENT", …; of added "NEW"
/// Whether it is a reason to look: different, slower or missing.
bool is_worse(Verdict verdict);

/// Runs of one experiment to hold side by side, each side the newest first. The first are compared; the others, which
/// repeat them, show by how much times differ from run to run.
struct RunPair {
    std::vector<RunRecord> before, after;
};

struct Pairing {
    std::vector<RunPair> pairs;
    std::vector<std::string> only_before, only_after;  ///< "EXPERIMENT (PROFILE, DEVICE)" without a partner
};

/// For each experiment whose name contains `only`: the newest runs of each device and profile that both sides have, or,
/// if they share none, the newest of either. Both newest first.
Pairing pair_runs(std::span<const RunRecord> before, std::span<const RunRecord> after, const std::string& only = "");

/// What became of one figure of one row; without a column, of a row as a whole; without both, of a file.
struct Cell {
    std::string file, column, row;  ///< row: its keys, ", " between them
    Verdict verdict = Verdict::same;
    std::string before = {}, after = {};    ///< as they were written; of several timings, their median
    double amount = 0;                      ///< how far apart, as the rule measures it; of times: after over before
    std::optional<Interval> interval = {};  ///< of a ratio of times
    std::string reason = {};                ///< why nothing can be said
    const ColumnRule* rule = nullptr;       ///< of a column that both have
};

/// Every figure of the newest runs of both sides. Throws UserError, naming the file: for rows that can't be read, or
/// matched, and for files and columns that have no rule (report/experiments.h).
std::vector<Cell> compare_runs(const RunPair& pair);

/// In what the newest runs differ so that their times mean different things: "device: A, then B"; empty if in nothing.
std::vector<std::string> what_sets_apart(const RunPair& pair);

/// What two sets of timings say of each other. Verdict: same (within 2 %), faster, slower or unclear.
struct TimeJudgement {
    Verdict verdict;
    double ratio = 0;  ///< of the medians, after over before
    std::optional<Interval> interval = {};
    std::string reason = {};
};
/// `run_to_run`: the factor by which times of one program differ from run to run, where each side's timings are
/// of one run; 1 where each timing is of a separate run. Unclear where it isn't known.
TimeJudgement judge_times(const std::vector<double>& before, const std::vector<double>& after,
                          std::optional<double> run_to_run);

}  // namespace radiafit::harness

#pragma once
#include <map>
#include <string>
#include <vector>

#include "report/compare.h"

/// What compare.h finds, put together for people: counted, and in few lines.
namespace radiafit::harness {

using VerdictCounts = std::map<Verdict, size_t>;

/// Two sides' runs of one experiment, and what differs.
struct Comparison {
    RunPair runs;
    std::vector<std::string> apart;  ///< what_sets_apart()
    std::vector<Cell> cells;
    VerdictCounts counts;
};

/// Throws UserError as compare_runs() does.
Comparison compare(RunPair runs);

/// Cells of one file with the same verdict, reported in one line: of one column, or of any where cells have no figures.
struct CellGroup {
    std::vector<const Cell*> cells;
    std::vector<std::string> columns;
    const Cell& worst() const;
    /// The row that worst() is of; empty where all have the same reason.
    std::string where() const;
};

/// Worst verdicts first, then as the files have them. `all`: what is the same, too.
std::vector<CellGroup> groups_of(const std::vector<Cell>& cells, bool all);

/// "27.6355, then 27.5012: 0.134 dB"; "1.23 times (1.18 to 1.29)"; or why nothing is said.
std::string figures_of(const Cell& cell);

std::string text_of(const VerdictCounts& counts);  ///< "2 DIFFERENT, 40 SAME"
std::string name_of(const RunRecord& run);         ///< "07aef08b7437 of 2026-11-23T12:16:54Z"

}  // namespace radiafit::harness

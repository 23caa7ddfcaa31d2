#pragma once
#include <string_view>
#include <vector>

#include "report/columns.h"

/// The experiments: what files each leaves, and what the report says of it. Each is defined in experiments/rows/NAME.h;
/// the build finds all of them.
namespace radiafit::harness {

struct ExperimentEntry {
    const char* name;
    const char* about;                  ///< what it measures: paragraphs of docs/results.md
    std::vector<const RowFile*> files;  ///< that every run leaves
    int place;                          ///< in the report and on the page; the table and figures of the paper first

    // What the report says (report.cpp of experiments/).
    const char* title = "";    ///< empty: the report has nothing of it
    const char* section = "";  ///< of the paper; empty: the paper has nothing like it
    const char* paper = "";    ///< what it states there, or that our text has lost it
    const char* figure = "";   ///< what is to be seen in the figure, for who cannot see it; empty: there is no figure
    /// Files of the run that are shown as tables: its NAME.md, or rows of which each is worth reading.
    std::vector<const char*> tables = {};
    const char* target = "experiments";  ///< of make, which makes the rows
};

/// By place.
const std::vector<const ExperimentEntry*>& all_experiments();
/// The experiments that the report shows.
std::vector<const ExperimentEntry*> reported_experiments();

/// What a file of an experiment is; null if it is of none.
const RowFile* find_row_file(std::string_view experiment, std::string_view file);

/// Where files of experiments are described, for messages.
constexpr const char* rows_folder = "experiments/rows";

}  // namespace radiafit::harness

#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "base/rings.h"

/// What the columns of the experiments' rows are, so that two runs can be compared: one table for all of them, in
/// columns.cpp.
namespace radiafit::harness {

enum class ColumnKind {
    key,         ///< rows of two runs that have the same keys are compared
    device,      ///< a key, of which only counts whether it is the CPU or OpenGL
    repetition,  ///< rows with the same keys measured the same several times
    work,        ///< what a row's other figures are of: where it differs, nothing of the row is compared
    exact,       ///< an accuracy figure, or a count, that is the same in every run: compared as text
    absolute,    ///< an accuracy figure with a tolerance in its own unit
    relative,    ///< an accuracy figure with a tolerance as a share of the larger of the two
    iterations,  ///< a count of iterations; below 0: never, which is like no count
    time,        ///< seconds: the lower the better
    memory,      ///< bytes that were reckoned or counted: the same in every run
    told         ///< said by the experiment, not compared
};

struct ColumnRule {
    ColumnKind kind;
    double tolerance = 0;   ///< of absolute, relative and iterations
    const char* unit = "";  ///< of absolute
};

/// The rules of one file of rows.
class TableRules {
public:
    struct Columns {
        ColumnRule rule;
        const char* names;  ///< between blanks; "*" is every other column
    };
    TableRules(const char* experiment, const char* file, std::vector<Columns> columns, bool partial = false);

    /// File names may begin with a dataset's, which "*" stands for.
    bool covers(std::string_view experiment, std::string_view file) const;
    /// The rule of a column; null if there is none.
    const ColumnRule* rule(std::string_view column) const;
    const std::vector<std::pair<std::string_view, ColumnRule>>& columns() const { return columns_; }
    /// Whether a slow machine writes fewer rows: those of one run only say nothing.
    bool partial() const { return partial_; }

private:
    std::string_view experiment_, file_;
    std::vector<std::pair<std::string_view, ColumnRule>> columns_;
    bool partial_;
};

/// The rules of a file of an experiment; null if there are none.
const TableRules* find_table_rules(std::string_view experiment, std::string_view file);

/// Where the table stands, for messages.
constexpr const char* columns_file = "src/report/columns.cpp";

}  // namespace radiafit::harness

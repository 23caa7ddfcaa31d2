#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "report/row_files.h"

namespace radiafit::harness {

/// What one run of an experiment left, for the rules.
class FinishedRun {
public:
    FinishedRun(RunRecord record, const std::filesystem::path& checkout);

    const std::string& name() const {
        return name_;
    }  ///< its path from the checkout on, or of one elsewhere from its results on
    const std::string& cpu() const { return record_.cpu; }
    bool rounds_left_out() const { return record_.rounds_left_out; }
    std::string device() const;  ///< the GL renderer, or the CPU and its threads
    /// A number of the resolved config. Throws UserError if there is none.
    double setting(const char* key) const;
    /// A text of the resolved config; empty if there is none.
    std::string text(const char* key) const;
    /// Throws UserError for a file that is missing, can't be read, or isn't as the run wrote it.
    CsvTable table(const std::string& file) const { return read_rows(record_, file); }
    bool has_table(const std::string& file) const { return has_run_file(record_, file); }

private:
    RunRecord record_;
    std::string name_;
};

/// The numbers of a column, row by row.
std::vector<double> column(const CsvTable& table, const char* name);

}  // namespace radiafit::harness

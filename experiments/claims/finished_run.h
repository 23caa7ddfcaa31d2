#pragma once
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "report/csv.h"

namespace radiafit {

/// What one run of an experiment left.
class FinishedRun {
public:
    /// Throws UserError if its run.json is no JSON object.
    FinishedRun(std::filesystem::path folder, const std::filesystem::path& checkout);

    const std::string& name() const { return name_; }  ///< its path from the checkout on
    int threads() const { return json_.value("threads", 0); }
    std::string cpu() const { return json_.value("cpu", "unknown CPU"); }
    std::string device() const;  ///< the GL renderer, or the CPU and its threads
    /// A number of the resolved config. Throws UserError if there is none.
    double setting(const char* key) const;
    /// A text of the resolved config; empty if there is none.
    std::string text(const char* key) const;
    /// Throws UserError for a file that is missing, can't be read, or isn't as the run wrote it.
    CsvTable table(const std::string& file) const;
    bool has_table(const std::string& file) const;
    /// The names of its files that end so, in order.
    std::vector<std::string> tables(const std::string& ending) const;

private:
    std::filesystem::path folder_;
    std::string name_;
    nlohmann::ordered_json json_;
};

/// The numbers of a column, row by row.
std::vector<double> column(const CsvTable& table, const char* name);

}  // namespace radiafit

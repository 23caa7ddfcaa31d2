#pragma once
#include <filesystem>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "report/csv.h"

/// The paper's claims, and for each the rule that judges it from the rows of one run.
namespace radiafit {

/// What one run of an experiment left.
class FinishedRun {
public:
    /// Throws UserError if its run.json is no JSON object.
    FinishedRun(std::filesystem::path folder, const std::filesystem::path& results);

    const std::string& name() const { return name_; }  ///< EXPERIMENT/DEVICE/UTC-REVISION
    int threads() const { return json_.value("threads", 0); }
    std::string cpu() const { return json_.value("cpu", "unknown CPU"); }
    std::string device() const;  ///< the GL renderer, or the CPU and its threads
    /// A number of the resolved config. Throws UserError if there is none.
    double setting(const char* key) const;
    /// A text of the resolved config; empty if there is none.
    std::string text(const char* key) const;
    CsvTable table(const char* file) const { return CsvTable(folder_ / file); }

private:
    std::filesystem::path folder_;
    std::string name_;
    nlohmann::ordered_json json_;
};

/// A verdict, and what it rests on. A rule adds one measure after another; the claim holds if all do.
struct Judgement {
    std::string verdict = "holds";  ///< or: does not hold, not comparable, not run
    std::string what = {};          ///< is measured, where the claim's own words don't tell
    std::vector<std::string> measures = {}, why = {};
    std::string renderer = {};           ///< of the figures; empty: what run.json says
    nlohmann::ordered_json values = {};  ///< the measures for programs

    void require(bool holds) {
        if (!holds) verdict = "does not hold";
    }
    void measure(bool holds, std::string text) {
        require(holds);
        measures.push_back(std::move(text));
    }
    /// What the rule asks of the run itself. After the measures: without it their verdict does not count.
    void demand(bool given, const std::string& condition) {
        if (given) return;
        verdict = "not comparable";
        why.push_back("the rule asks for " + condition);
    }
};

struct Claim {
    const char *id, *section, *states, *rule;
    const char* experiment;                      ///< whose rows it is judged from; null: there is none yet
    Judgement (*judge)(const FinishedRun& run);  ///< throws UserError for rows that lack what it needs
};
std::span<const Claim> claims();

}  // namespace radiafit

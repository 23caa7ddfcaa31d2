// The paper's claims, each judged by its rule over the newest results of the other experiments. Nothing is measured
// here, and no verdict is typed in: what has not been run says so.
#include <fmt/format.h>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/log.h"
#include "claim_rules.h"
#include "experiment.h"
#include "report/table.h"

namespace radiafit {
namespace {

namespace fs = std::filesystem;

struct Row {
    const Claim* claim;
    Judgement judgement;
    std::string run;  ///< that it was judged from
};

Judgement not_run(const std::string& why) { return {.verdict = "not run", .why = {why}}; }

Judgement judge(const Claim& claim, const FinishedRun& run) {
    Judgement j;
    try {
        j = claim.judge(run);
    } catch (const UserError& e) {  // a run of an older version, or a damaged one
        j = not_run(e.what());
    }
    if (j.renderer.empty()) j.renderer = run.device();
    // rows say "cpu, 2 threads"
    if (const size_t at = j.renderer.find("cpu,"); at != std::string::npos) j.renderer.replace(at, 3, run.cpu());
    return j;
}

/// One row for every device that has results of this profile; one that says "not run" if none has.
std::vector<Row> judge_all(const fs::path& results, const std::string& profile) {
    std::vector<Row> rows;
    for (const Claim& claim : claims()) {
        if (!claim.experiment) {
            rows.push_back({&claim, not_run("no experiment judges it yet"), ""});
            continue;
        }
        const auto folders = newest_runs(results, claim.experiment, profile);
        for (const fs::path& folder : folders) {
            const FinishedRun run(folder, results);
            rows.push_back({&claim, judge(claim, run), run.name()});
        }
        if (folders.empty())
            rows.push_back({&claim,
                            not_run(fmt::format("no {0} results; make experiments PROFILE={0} ONLY={1}", profile,
                                                claim.experiment)),
                            ""});
    }
    return rows;
}

void write_claims(Experiment& experiment) {
    std::string folder = "results";
    experiment.config().read("results", folder, [](const std::string& name) {
        if (name.empty()) throw UserError("results = '': name the folder that the runs lie in");
    });
    experiment.config().finish();
    const fs::path results = experiment.root() / folder;
    const std::vector<Row> rows = judge_all(results, experiment.profile());

    nlohmann::ordered_json json = {{"format", "radiafit-claims"}, {"version", 1}, {"profile", experiment.profile()}};
    Table shown({"claim", "section", "the paper states", "measured here", "verdict", "renderer"});
    Table report({"claim", "section", "the paper states", "rule", "measured here", "verdict", "why", "renderer"});
    for (const Row& row : rows) {
        const Claim& c = *row.claim;
        const Judgement& j = row.judgement;
        const std::string value = j.what + fmt::format("{}", fmt::join(j.measures, "; "));
        const std::string why = fmt::format("{}", fmt::join(j.why, "; "));
        json["claims"].push_back({{"id", c.id},
                                  {"section", c.section},
                                  {"paper", c.states},
                                  {"rule", c.rule},
                                  {"value", value},
                                  {"values", j.values},
                                  {"verdict", j.verdict},
                                  {"why", why},
                                  {"renderer", j.renderer},
                                  {"profile", experiment.profile()},
                                  {"run", row.run}});
        shown.add({c.id, c.section, c.states, value, j.verdict, j.renderer});
        report.add({c.id, c.section, c.states, c.rule, value, j.verdict, why, j.renderer});
    }
    fs::create_directories(results);
    write_file(results / "claims.json", json.dump(2) + "\n");
    write_file(experiment.figures() / "claims.md",
               fmt::format("Claims of the paper, {} profile, {}\n\n{}", experiment.profile(), utc_now().substr(0, 10),
                           report.markdown()));
    log_info("the paper's claims, as measured here\n" + shown.text());
    log_info(fmt::format("verdicts: {} and {}", (results / "claims.json").string(),
                         (experiment.figures() / "claims.md").string()));
}

}  // namespace
}  // namespace radiafit

int main(int argc, char** argv) { return radiafit::run_experiment("claims", argc, argv, radiafit::write_claims); }

// The paper's claims, each judged by its rule from the rows of the other experiments. Nothing is measured here, and no
// verdict is typed in: what has not been run says so. Claims are judged at the paper's scale, by the newest run or,
// where there is none, by the one that came with the checkout; figures of a smaller profile are shown beside and decide
// nothing.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/log.h"
#include "claims/findings.h"
#include "experiment.h"
#include "report/table.h"

namespace radiafit::harness {
namespace {

namespace fs = std::filesystem;

nlohmann::ordered_json json_of(const Finding& f) {
    return {{"id", f.claim->id},
            {"section", f.claim->section},
            {"paper", f.claim->states},
            {"rule", f.claim->rule},
            {"profile", f.profile},
            {"verdict", f.verdict()},
            {"by_the_rule", f.by_the_rule()},
            {"reason", f.reason()},
            {"sentence", f.judgement.sentence},
            {"measures", f.judgement.json()},
            {"beside", f.judgement.beside},
            {"renderer", f.judgement.renderer},
            {"run", f.run}};
}

/// One claim's part of the page: what the paper states, the rule, and what every run found.
std::string section_of(const Claim& claim, const std::vector<const Finding*>& findings) {
    std::string text = fmt::format("## {}: {}\n\nThe paper, Section {}. Rule: {}.\n", claim.id, claim.states,
                                   claim.section, claim.rule);
    for (const Finding* finding : findings) {
        const Finding& f = *finding;
        const Judgement& j = f.judgement;
        text += fmt::format("\n**{}**, {} profile{}", f.verdict(), f.profile,
                            f.run.empty() ? "" : fmt::format("; {}; `{}`", j.renderer, f.run));
        if (const std::string reason = f.reason(); !reason.empty()) text += fmt::format(". Why: {}", reason);
        text += ".\n";
        if (!f.judged() && !f.run.empty()) text += fmt::format("By the rule alone: {}.\n", f.by_the_rule());
        if (!j.sentence.empty()) text += "\n" + j.sentence + "\n";
        if (!j.measures.empty()) text += "\n" + j.table().markdown();
        if (!j.beside.empty()) text += fmt::format("\nBeside it:\n\n- {}\n", fmt::join(j.beside, "\n- "));
    }
    return text;
}

void write_claims(Experiment& experiment) {
    const RunFolders folders(experiment);
    const bool beside_rows = experiment.standard();
    if (!beside_rows && experiment.results() == experiment.root() / "results")
        throw UserError(
            "claims.json in `results` is of the standard configuration; say by --output where the verdicts go");
    const std::string& profile = experiment.profile();

    nlohmann::ordered_json json = {{"format", "radiafit-claims"}, {"version", 2}, {"profile", profile}};
    Table shown({"claim", "the paper states", "found", "verdict", "by the rule, at smaller scale"});
    std::string sections;
    for (const ClaimFindings& found : find_claims(folders, profile)) {
        const Claim& claim = *found.claim;
        for (const ClaimFindings::Line& line : found.lines())
            shown.add({claim.id, claim.states, line.found(), line.verdict(), line.at_smaller_scale()});
        for (const Finding* f : found.all()) json["claims"].push_back(json_of(*f));
        sections += "\n" + section_of(claim, found.all());
    }
    const fs::path verdicts =
        experiment.results() /
        (profile == "standard" || !beside_rows ? "claims.json" : fmt::format("claims-{}.json", profile));
    fs::create_directories(verdicts.parent_path());
    fs::create_directories(experiment.figures());
    write_file(verdicts, json.dump(2) + "\n");
    write_file(
        experiment.figures() / "claims.md",
        fmt::format(
            "# The paper's claims\n\nJudged at the paper's scale; {}, {} profile. A figure's interval of 95 % lies "
            "within what the rule asks for (holds), apart from it (does not hold) or across its edge "
            "(undecided).\n\n{}{}",
            utc_now().substr(0, 10), profile, shown.markdown(), sections));
    log_info("the paper's claims, as measured here\n" + shown.text());
    log_info(fmt::format("verdicts: {} and {}", verdicts.string(), (experiment.figures() / "claims.md").string()));
}

}  // namespace
}  // namespace radiafit::harness

int main(int argc, char** argv) {
    return radiafit::harness::run_experiment("claims", argc, argv, radiafit::harness::write_claims,
                                             radiafit::harness::RunOption::results);
}

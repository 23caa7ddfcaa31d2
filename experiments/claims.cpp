// The paper's claims, each judged by its rule from the rows of the other experiments. Nothing is measured here, and no
// verdict is typed in: what has not been run says so. Claims are judged at the paper's scale, by the newest run or,
// where there is none, by the one that came with the checkout; figures of a smaller profile stand beside and decide
// nothing.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/log.h"
#include "claims/rules.h"
#include "experiment.h"
#include "gl/context.h"
#include "report/table.h"

namespace radiafit {
namespace {

namespace fs = std::filesystem;

constexpr const char* judged_profile = "paper";

/// What one run says of one claim.
struct Finding {
    const Claim* claim;
    std::string profile, run;  ///< its folder; empty: there is none
    Judgement judgement;

    bool judged() const { return profile == judged_profile; }
    std::string verdict() const {
        if (judged() || !judgement.not_run.empty()) return judgement.verdict();
        return "not comparable";
    }
    /// What the rule says of the figures, whatever their scale.
    std::string by_the_rule() const { return judgement.verdict(); }
    std::string reason() const {
        const std::string reason = judgement.reason();
        if (judged() || !judgement.not_run.empty()) return reason;
        return fmt::format("the {} profile is not of the paper's scale{}{}", profile, reason.empty() ? "" : "; ",
                           reason);
    }
};

Judgement judge(const Claim& claim, const FinishedRun& run) {
    Judgement j;
    try {
        j = claim.judge(run);
    } catch (const UserError& e) {  // a run of an older version, or a damaged one
        j = {.not_run = e.what()};
    }
    if (j.renderer.empty()) j.renderer = run.device();
    // rows say "cpu, 2 threads"
    if (const size_t at = j.renderer.find("cpu,"); at != std::string::npos)
        j.renderer.replace(at, 3, run.cpu());
    else if (is_software_renderer(j.renderer))
        j.renderer += ", " + run.cpu();
    return j;
}

/// By the newest run of each device in the first of the folders that has any; runs are named from the checkout on.
std::vector<Finding> findings_of(const Claim& claim, const std::string& profile, std::span<const fs::path> roots,
                                 const fs::path& checkout) {
    std::vector<Finding> findings;
    for (const fs::path& root : roots) {
        for (RunRecord& record : newest_runs(root, claim.experiment, profile)) {
            const FinishedRun run(std::move(record), checkout);
            findings.push_back({&claim, profile, run.name(), judge(claim, run)});
        }
        if (!findings.empty()) return findings;
    }
    Judgement none{.not_run =
                       fmt::format("no {0} results; make experiments PROFILE={0} ONLY={1}", profile, claim.experiment)};
    return {{&claim, profile, "", none}};
}

/// In order, those that either profile has figures of; one without a name if there are none.
std::vector<std::string> renderers_of(std::span<const Finding> paper, std::span<const Finding> beside) {
    std::vector<std::string> names;
    for (const auto findings : {paper, beside})
        for (const Finding& f : findings)
            if (!f.run.empty() && !std::ranges::count(names, f.judgement.renderer))
                names.push_back(f.judgement.renderer);
    if (names.empty()) names.push_back("");
    return names;
}

/// Null if there is none.
const Finding* of_renderer(std::span<const Finding> findings, const std::string& renderer) {
    const auto found =
        std::ranges::find_if(findings, [&](const Finding& f) { return f.judgement.renderer == renderer; });
    return found == findings.end() ? nullptr : &*found;
}

/// One line of the short table: what was found at the paper's scale or, for want of that, at a smaller one.
std::vector<std::string> short_row(const Claim& claim, const Finding* paper, const Finding* smaller) {
    const Finding* told = paper && !paper->judgement.sentence.empty() ? paper : smaller;
    std::string found = told ? told->judgement.sentence : "";
    if (!found.empty() && !told->judged()) found += fmt::format(" ({} profile)", told->profile);
    return {claim.id, claim.states, found, paper ? paper->verdict() : "not run", smaller ? smaller->by_the_rule() : ""};
}

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

/// One claim's part of the report: what the paper states, the rule, and what every run found.
std::string section_of(const Claim& claim, std::span<const Finding> findings) {
    std::string text = fmt::format("## {}: {}\n\nThe paper, Section {}. Rule: {}.\n", claim.id, claim.states,
                                   claim.section, claim.rule);
    for (const Finding& f : findings) {
        const Judgement& j = f.judgement;
        text += fmt::format("\n**{}**, {} profile{}", f.verdict(), f.profile,
                            f.run.empty() ? "" : fmt::format("; {}; `{}`", j.renderer, f.run));
        if (const std::string reason = f.reason(); !reason.empty()) text += fmt::format(". Why: {}", reason);
        text += ".\n";
        if (!f.judged() && !f.run.empty()) text += fmt::format("By the rule alone: {}.\n", f.by_the_rule());
        if (!j.sentence.empty()) text += "\n" + j.sentence + "\n";
        if (!j.measures.empty()) {
            Table table({"measured", "value", "95 % interval", "asked for", "so it"});
            for (const Measure& m : j.measures)
                table.add({m.of, m.value_text(), m.interval_text(), j.no_rule.empty() ? m.bound.text(m.unit) : "",
                           j.no_rule.empty() ? to_string(m.outcome()) : ""});
            text += "\n" + table.markdown();
        }
        if (!j.beside.empty()) text += fmt::format("\nBeside it:\n\n- {}\n", fmt::join(j.beside, "\n- "));
    }
    return text;
}

void write_claims(Experiment& experiment) {
    std::string folder = "results";
    experiment.config().read("results", folder, [](const std::string& name) {
        if (name.empty()) throw UserError("results = '': name the folder that the runs lie in");
    });
    experiment.config().finish();
    const fs::path results = experiment.root() / folder;
    const bool beside_rows = experiment.standard();
    if (!beside_rows && experiment.results() == experiment.root() / "results")
        throw UserError(
            "claims.json in `results` is of the standard configuration; say by --output where the verdicts go");
    const fs::path roots[] = {results, experiment.root() / "results" / "reference"};
    const std::string& profile = experiment.profile();

    nlohmann::ordered_json json = {{"format", "radiafit-claims"}, {"version", 2}, {"profile", profile}};
    Table shown({"claim", "the paper states", "found", "verdict", "by the rule, at smaller scale"});
    std::string sections;
    for (const Claim& claim : claims()) {
        std::vector<Finding> findings = findings_of(claim, judged_profile, roots, experiment.root());
        const std::vector<Finding> smaller = profile == judged_profile
                                                 ? std::vector<Finding>()
                                                 : findings_of(claim, profile, std::span(roots, 1), experiment.root());
        for (const std::string& renderer : renderers_of(findings, smaller))
            shown.add(short_row(claim, of_renderer(findings, renderer), of_renderer(smaller, renderer)));
        findings.insert(findings.end(), smaller.begin(), smaller.end());
        for (const Finding& f : findings) json["claims"].push_back(json_of(f));
        sections += "\n" + section_of(claim, findings);
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
}  // namespace radiafit

int main(int argc, char** argv) { return radiafit::run_experiment("claims", argc, argv, radiafit::write_claims); }

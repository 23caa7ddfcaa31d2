// The paper's claims, each judged by its rule from the rows of the other experiments. Nothing is measured here, and no
// verdict is typed in: what has not been run says so. Claims are judged at the paper's scale, by runs of one's own or,
// where there are none, by the one that came with the checkout; figures of a smaller profile are shown beside and
// decide nothing.
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

nlohmann::ordered_json json_of(const Finding& f, const std::vector<Judgement>& judgements) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const Judgement& j : judgements) {
        nlohmann::ordered_json one;
        if (!j.rule->name.empty()) one["name"] = j.rule->name;
        one["rule"] = j.rule->text;
        if (!j.rule->computed.empty()) one["computed"] = j.rule->computed;
        if (!j.rule->until.empty()) one["until"] = j.rule->until;
        if (!j.rule->changed.empty()) one["changed"] = j.rule->changed;
        one["verdict"] = f.verdict(j);
        one["by_the_rule"] = j.verdict();
        one["reason"] = j.reason();
        one["measures"] = j.json();
        list.push_back(one);
    }
    return list;
}

nlohmann::ordered_json json_of(const Finding& f, bool told_first) {
    return {{"id", f.claim->id},
            {"section", f.claim->section},
            {"paper", f.claim->states},
            {"rule", f.claim->rule.text},
            {"since", f.claim->rule.since},
            {"why_this_rule", f.claim->rule.reason},
            {"computed", f.claim->rule.computed},
            {"scale", f.claim->rule.scale},
            {"command", fmt::format("make experiments PROFILE={} ONLY={}", f.profile, f.claim->experiment)},
            {"profile", f.profile},
            {"verdict", f.verdict()},
            {"by_the_rule", f.by_the_rule()},
            {"reason", f.reason()},
            {"decided_by", f.decided_by()},
            {"rule_is_younger_than_rows", f.rule_is_younger()},
            {"sentence", f.evidence.sentence},
            {"measures", f.judgement.json()},
            {"readings", json_of(f, f.readings)},
            {"former", json_of(f, f.former)},
            {"beside", f.evidence.beside},
            {"renderer", f.evidence.renderer},
            {"run", f.run},
            {"told_first", told_first}};
}

/// A run of other settings: what the rules' bounds say of its figures.
nlohmann::ordered_json json_of_varied(const Finding& f) {
    nlohmann::ordered_json readings = nlohmann::ordered_json::array();
    for (const Judgement& j : f.readings)
        readings.push_back(
            {{"name", j.rule->name}, {"by_the_measures", to_string(j.outcome())}, {"measures", j.json()}});
    return {{"id", f.claim->id},
            {"settings", f.settings},
            {"by_the_measures", f.by_the_measures()},
            {"sentence", f.evidence.sentence},
            {"measures", f.judgement.json()},
            {"readings", readings},
            {"renderer", f.evidence.renderer},
            {"run", f.run}};
}

/// A verdict, and why there is no other one.
std::string told(const ClaimFindings::Line& line) {
    const std::string verdict = line.verdict(), why = line.judged ? line.judged->reason() : "";
    const bool open = verdict == "undecided" || verdict == "not comparable";
    return open && !why.empty() ? fmt::format("{}: {}", verdict, why) : verdict;
}

std::string told(const Finding& f, const Judgement& j) {
    std::string text = fmt::format("**{}**", f.verdict(j));
    if (const std::string reason = j.reason(); !reason.empty()) text += fmt::format(": {}", reason);
    text += ".\n";
    if (!j.measures.empty()) text += "\n" + j.table().markdown();
    return text;
}

/// One claim's part of the page: what the paper states, the rules, and what every run found.
std::string section_of(const ClaimFindings& found) {
    const Claim& claim = *found.claim;
    const Rule& rule = claim.rule;
    std::string text =
        fmt::format("## {}: {}\n\nThe paper, Section {}. Rule, since {}: {}.\n\nWhy this one: {}.\n\nScale: {}.\n",
                    claim.id, claim.states, claim.section, rule.since, rule.text, rule.reason, rule.scale);
    const auto add_computed = [&](const Rule& of) {
        if (!of.computed.empty()) text += fmt::format("\nComputed so: {}.\n", of.computed);
    };
    add_computed(rule);
    for (const Rule& reading : claim.readings) {
        text += fmt::format("\nAnother reading, {}: {}.\n", reading.name, reading.text);
        add_computed(reading);
    }
    for (const Rule& former : claim.former)
        text += fmt::format("\nUntil {} the rule was: {}. It changed because {}.\n", former.until, former.text,
                            former.changed);
    for (const Finding* finding : found.all()) {
        const Finding& f = *finding;
        text += fmt::format("\n**{}**, {} profile{}", f.verdict(), f.profile,
                            f.run.empty() ? "" : fmt::format("; {}; `{}`", f.evidence.renderer, f.run));
        if (const std::string reason = f.reason(); !reason.empty()) text += fmt::format(". Why: {}", reason);
        if (const std::string run = f.decided_by(); !run.empty()) text += fmt::format(". What decides it: {}", run);
        text += ".\n";
        if (f.rule_is_younger()) text += "\nThese rows are older than the rule.\n";
        if (!f.judged() && !f.run.empty()) text += fmt::format("By the rule alone: {}.\n", f.by_the_rule());
        if (!f.evidence.sentence.empty()) text += "\n" + f.evidence.sentence + "\n";
        if (!f.judgement.measures.empty()) text += "\n" + f.judgement.table().markdown();
        for (const Judgement& j : f.readings)
            text += fmt::format("\nBy the other reading, {}: {}", j.rule->name, told(f, j));
        for (const Judgement& j : f.former)
            text += fmt::format("\nBy the rule until {}: {}", j.rule->until, told(f, j));
        if (!f.evidence.beside.empty())
            text += fmt::format("\nBeside it:\n\n- {}\n", fmt::join(f.evidence.beside, "\n- "));
    }
    for (const Finding& f : found.varied) {
        text += fmt::format("\nWith {}, {}; `{}`: by the measures **{}**.\n\n{}\n\n{}", f.settings, f.evidence.renderer,
                            f.run, f.by_the_measures(), f.evidence.sentence, f.judgement.table().markdown());
        for (const Judgement& j : f.readings)
            text += fmt::format("\nBy the other reading, {}: **{}**.\n\n{}", j.rule->name, to_string(j.outcome()),
                                j.table().markdown());
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

    nlohmann::ordered_json json = {{"format", "radiafit-claims"}, {"version", 3}, {"profile", profile}};
    json["claims"] = nlohmann::ordered_json::array();
    json["varied"] = nlohmann::ordered_json::array();
    Table shown({"claim", "the paper states", "found", "verdict", "by other rules", "by the rule, at smaller scale"});
    std::string sections;
    for (const ClaimFindings& found : find_claims(folders, profile)) {
        const Claim& claim = *found.claim;
        for (const ClaimFindings::Line& line : found.lines())
            shown.add(
                {claim.id, claim.states, line.found(), told(line), line.by_other_rules(), line.at_smaller_scale()});
        for (const Finding* f : found.all()) json["claims"].push_back(json_of(*f, f == &found.first()));
        for (const Finding& f : found.varied) json["varied"].push_back(json_of_varied(f));
        sections += "\n" + section_of(found);
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

#include "findings.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "base/error.h"
#include "experiment.h"
#include "gl/context.h"

namespace radiafit::harness {
namespace {

Evidence find(const Claim& claim, const FinishedRun& run) {
    Evidence e;
    try {
        e = claim.find(run);
    } catch (const UserError& error) {  // a run of an older version, or a damaged one
        e = {.not_run = error.what()};
    }
    if (e.renderer.empty()) e.renderer = run.device();
    // rows say "cpu, 2 threads"
    if (const size_t at = e.renderer.find("cpu,"); at != std::string::npos)
        e.renderer.replace(at, 3, run.cpu());
    else if (is_software_renderer(e.renderer))
        e.renderer += ", " + run.cpu();
    return e;
}

Finding judged_by_all_rules(Finding finding) {
    const auto all = [&](const std::vector<Rule>& rules) {
        std::vector<Judgement> judgements;
        for (const Rule& rule : rules) judgements.push_back(judge(rule, finding.evidence));
        return judgements;
    };
    finding.judgement = judge(finding.claim->rule, finding.evidence);
    finding.readings = all(finding.claim->readings);
    finding.former = all(finding.claim->former);
    return finding;
}

std::vector<Finding> findings_of(const Claim& claim, const std::string& profile, std::vector<RunRecord> runs,
                                 const std::filesystem::path& checkout) {
    std::vector<Finding> findings;
    for (RunRecord& record : runs) {
        const FinishedRun run(std::move(record), checkout);
        Finding finding{&claim, profile, run.name(), find(claim, run)};
        finding.rounds_left_out = run.rounds_left_out();
        findings.push_back(judged_by_all_rules(std::move(finding)));
    }
    if (!findings.empty()) return findings;
    Evidence none{.not_run =
                      fmt::format("no {0} results; make experiments PROFILE={0} ONLY={1}", profile, claim.experiment)};
    return {judged_by_all_rules({&claim, profile, "", none})};
}

/// "object = 2, vertices = 300": object or weight first, then what else differs from the standard run's settings, if
/// the objects or their weight do.
std::string differing(const RunRecord& run, const RunRecord& standard) {
    std::vector<std::string> all;
    bool others = false;
    for (const auto& [key, own] : run.config) {
        const auto usual = standard.config.find(key);
        // rows from before there were other objects are of the first one
        if (own == (usual != standard.config.end() ? usual->second : key == "object" ? "1" : own)) continue;
        const bool tells = key == "object" || key == "lambda";
        others = others || tells;
        all.insert(tells ? all.begin() : all.end(), fmt::format("{} = {}", key, own));
    }
    return others ? fmt::format("{}", fmt::join(all, ", ")) : "";
}

/// Of the reference's, or the user's own, runs with other objects or weights.
std::vector<Finding> varied_findings(const Claim& claim, const RunFolders& folders) {
    const std::vector<RunRecord> standard = folders.newest(claim.experiment, judged_profile);
    std::vector<RunRecord> runs = varied_runs(folders.results, claim.experiment, judged_profile);
    if (runs.empty()) runs = varied_runs(folders.reference, claim.experiment, judged_profile);  // as newest() does
    if (standard.empty()) return {};
    const RunRecord& usual =
        *std::ranges::max_element(standard, {}, [](const RunRecord& run) { return run.folder.filename(); });
    std::vector<Finding> findings;
    for (RunRecord& record : runs) {
        const std::string settings = differing(record, usual);
        if (settings.empty()) continue;
        const FinishedRun run(std::move(record), folders.checkout);
        Finding finding{&claim, judged_profile, run.name(), find(claim, run)};
        if (!finding.evidence.not_run.empty()) continue;
        finding.settings = settings;
        findings.push_back(judged_by_all_rules(std::move(finding)));
    }
    return findings;
}

/// The one that is told first; null if there is none.
const Finding* of_renderer(const std::vector<Finding>& findings, const std::string& renderer) {
    const Finding* first = nullptr;
    for (const Finding& f : findings)
        if (f.evidence.renderer == renderer && (!first || first->precedence() < f.precedence())) first = &f;
    return first;
}

}  // namespace

RunFolders::RunFolders(Experiment& experiment) : checkout(experiment.root()) {
    std::string folder = "results";
    experiment.config().read("results", folder, [](const std::string& name) {
        if (name.empty()) throw UserError("results = '': name the folder that the runs lie in");
    });
    experiment.config().finish();
    results = checkout / folder;
    reference = checkout / "results" / "reference";
}

std::vector<RunRecord> RunFolders::newest(const std::string& experiment, const std::string& profile) const {
    std::vector<RunRecord> runs = newest_runs(results, experiment, profile);
    return runs.empty() ? newest_runs(reference, experiment, profile) : runs;
}

std::string Finding::verdict(const Judgement& by) const {
    if (judged() || !by.not_run.empty()) return by.verdict();
    return "not comparable";
}

bool Finding::rule_is_younger() const {
    // Names of runs begin with their day: 20261123T134329Z.
    const std::string name = std::filesystem::path(run).filename().string();
    std::string day = claim->rule.since;
    std::erase(day, '-');
    return !run.empty() && name.substr(0, day.size()) < day;
}

std::vector<std::string> Finding::other_verdicts() const {
    std::vector<std::string> all;
    for (const Judgement& j : readings) all.push_back(fmt::format("{}: {}", j.rule->name, verdict(j)));
    for (const Judgement& j : former) all.push_back(fmt::format("by the rule until {}: {}", j.rule->until, verdict(j)));
    return all;
}

std::string Finding::reason() const {
    const std::string reason = judgement.reason();
    if (judged() || !judgement.not_run.empty()) return reason;
    return fmt::format("the {} profile is not of the paper's scale{}{}", profile, reason.empty() ? "" : "; ", reason);
}

std::string Finding::decided_by() const {
    const bool waits =
        std::ranges::count(judgement.rule->premises, "graphics chip") > 0 && is_software_renderer(evidence.renderer);
    if (!waits || !judgement.not_run.empty()) return "";
    return fmt::format("`make experiments PROFILE={} ONLY={}` on a machine with a graphics chip", judged_profile,
                       claim->experiment);
}

std::string ClaimFindings::Line::found() const {
    const Finding* told = judged && !judged->evidence.sentence.empty() ? judged : smaller;
    std::string found = told ? told->evidence.sentence : "";
    if (!found.empty() && !told->judged()) found += fmt::format(" ({} profile)", told->profile);
    return found;
}

std::string ClaimFindings::Line::by_other_rules() const {
    if (!judged || !judged->judgement.not_run.empty()) return "";
    std::vector<std::string> all = judged->other_verdicts();
    if (judged->rule_is_younger()) all.emplace_back("these rows are older than the rule");
    for (const Finding* other : varied) {
        const size_t comma = other->settings.find(',');  // sizes are told where the run is
        const std::string with = other->settings.substr(0, comma) + (comma == std::string::npos ? "" : " …");
        all.push_back(fmt::format("with {}: {}", with, other->by_the_measures()));
        for (const Judgement& j : other->readings)
            all.push_back(fmt::format("with {}, {}: {}", with, j.rule->name, to_string(j.outcome())));
    }
    return fmt::format("{}", fmt::join(all, "; "));
}

std::vector<ClaimFindings::Line> ClaimFindings::lines() const {
    std::vector<std::string> renderers;
    for (const Finding* f : all())
        if (!f->run.empty() && !std::ranges::count(renderers, f->evidence.renderer))
            renderers.push_back(f->evidence.renderer);
    if (renderers.empty()) renderers.emplace_back();
    std::vector<Line> lines;
    for (const std::string& renderer : renderers) {
        lines.push_back({of_renderer(judged, renderer), of_renderer(smaller, renderer)});
    }
    const auto at = std::ranges::find(lines, &this->first(), &Line::judged);
    Line& first = at == lines.end() ? lines.front() : *at;
    for (const Finding& other : varied) {
        const auto own = std::ranges::find(renderers, other.evidence.renderer);
        Line& same = own == renderers.end() ? first : lines[size_t(own - renderers.begin())];
        (same.judged ? same : first).varied.push_back(&other);
    }
    return lines;
}

std::vector<const Finding*> ClaimFindings::all() const {
    std::vector<const Finding*> all;
    for (const auto* findings : {&judged, &smaller})
        for (const Finding& f : *findings) all.push_back(&f);
    return all;
}

std::vector<ClaimFindings> find_claims(const RunFolders& folders, const std::string& profile) {
    std::vector<ClaimFindings> found;
    for (const Claim& claim : claims()) {
        ClaimFindings& one = found.emplace_back();
        one.claim = &claim;
        one.judged =
            findings_of(claim, judged_profile, folders.newest(claim.experiment, judged_profile), folders.checkout);
        if (profile != judged_profile)  // from the results alone: runs of the checkout are for the judged profile
            one.smaller =
                findings_of(claim, profile, newest_runs(folders.results, claim.experiment, profile), folders.checkout);
        one.varied = varied_findings(claim, folders);
    }
    return found;
}

}  // namespace radiafit::harness

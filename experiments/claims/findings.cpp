#include "findings.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.h"
#include "experiment.h"
#include "gl/context.h"

namespace radiafit::harness {
namespace {

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

std::vector<Finding> findings_of(const Claim& claim, const std::string& profile, std::vector<RunRecord> runs,
                                 const std::filesystem::path& checkout) {
    std::vector<Finding> findings;
    for (RunRecord& record : runs) {
        const FinishedRun run(std::move(record), checkout);
        findings.push_back({&claim, profile, run.name(), judge(claim, run)});
    }
    if (!findings.empty()) return findings;
    Judgement none{.not_run =
                       fmt::format("no {0} results; make experiments PROFILE={0} ONLY={1}", profile, claim.experiment)};
    return {{&claim, profile, "", none}};
}

/// Null if there is none.
const Finding* of_renderer(const std::vector<Finding>& findings, const std::string& renderer) {
    const auto found =
        std::ranges::find_if(findings, [&](const Finding& f) { return f.judgement.renderer == renderer; });
    return found == findings.end() ? nullptr : &*found;
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

std::string Finding::verdict() const {
    if (judged() || !judgement.not_run.empty()) return judgement.verdict();
    return "not comparable";
}

std::string Finding::reason() const {
    const std::string reason = judgement.reason();
    if (judged() || !judgement.not_run.empty()) return reason;
    return fmt::format("the {} profile is not of the paper's scale{}{}", profile, reason.empty() ? "" : "; ", reason);
}

std::string ClaimFindings::Line::found() const {
    const Finding* told = judged && !judged->judgement.sentence.empty() ? judged : smaller;
    std::string found = told ? told->judgement.sentence : "";
    if (!found.empty() && !told->judged()) found += fmt::format(" ({} profile)", told->profile);
    return found;
}

std::vector<ClaimFindings::Line> ClaimFindings::lines() const {
    std::vector<std::string> renderers;
    for (const Finding* f : all())
        if (!f->run.empty() && !std::ranges::count(renderers, f->judgement.renderer))
            renderers.push_back(f->judgement.renderer);
    if (renderers.empty()) renderers.emplace_back();
    std::vector<Line> lines;
    for (const std::string& renderer : renderers)
        lines.push_back({of_renderer(judged, renderer), of_renderer(smaller, renderer)});
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
    }
    return found;
}

}  // namespace radiafit::harness

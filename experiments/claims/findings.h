#pragma once
#include <algorithm>
#include <filesystem>
#include <span>
#include <string>
#include <tuple>
#include <vector>

#include "report/finished_runs.h"
#include "rules.h"

namespace radiafit::harness {
class Experiment;

/// Claims are judged at the paper's scale; figures of a smaller profile are shown beside and decide nothing.
inline constexpr const char* judged_profile = "paper";

/// Where runs lie, by an experiment's config (`results`), and then those that came with the checkout.
struct RunFolders {
    std::filesystem::path results, reference;
    std::filesystem::path checkout;  ///< runs are named from it on

    explicit RunFolders(Experiment& experiment);
    /// The newest run of each device in the first of both that has any.
    std::vector<RunRecord> newest(const std::string& experiment, const std::string& profile) const;
};

/// What one run says of one claim.
struct Finding {
    const Claim* claim;
    std::string profile, run;  ///< its folder; empty: there is none
    Evidence evidence;
    Judgement judgement = {};                           ///< by the rule that decides
    std::vector<Judgement> readings = {}, former = {};  ///< by the claim's other rules, in their order

    bool judged() const { return profile == judged_profile; }
    std::string run_name() const { return std::filesystem::path(run).filename().string(); }  ///< begins with its time
    std::string verdict() const { return verdict(judgement); }
    /// Of any of the rules.
    std::string verdict(const Judgement& by) const;
    /// What the rule says of the figures, whatever their scale.
    std::string by_the_rule() const { return judgement.verdict(); }
    /// The same whatever the run is, for those of other settings.
    std::string by_the_measures() const { return to_string(judgement.outcome()); }
    std::string reason() const;
    /// What would decide a claim that waits for a graphics chip; else empty.
    std::string decided_by() const;
    /// Whether the rule was registered on a later day than the rows are of.
    bool rule_is_younger() const;
    /// Of a run of other settings: what differs, "object = 2"; else empty.
    std::string settings = {};
    bool rounds_left_out = false;  ///< of the run, as its time was up
    /// Of several findings the largest is told first: one of a run that the claim can be judged by, then one of a run
    /// whose rounds are all there, then the newest.
    std::tuple<bool, bool, std::string> precedence() const {
        return {judgement.not_run.empty() && judgement.unmet.empty(), !rounds_left_out, run_name()};
    }
    /// Verdicts of the other rules, in words: "as mathematics: undecided"; "by the rule until 2026-11-27: holds".
    std::vector<std::string> other_verdicts() const;
};

/// All that is found of one claim; where nothing was run, one finding of the judged profile says so.
struct ClaimFindings {
    const Claim* claim;
    std::vector<Finding> judged;   ///< of each device
    std::vector<Finding> smaller;  ///< of another profile, which was asked for; none if that is the judged one
    std::vector<Finding> varied;   ///< of other objects and other weights: by the measures alone, nothing is judged

    /// A summary for one renderer: what was found at the paper's scale or, for want of that, at a smaller one.
    struct Line {
        const Finding* judged;   ///< null: there is none
        const Finding* smaller;  ///< at a smaller scale; null: there is none
        std::vector<const Finding*> varied = {};
        std::string found() const;
        std::string verdict() const { return judged ? judged->verdict() : "not run"; }
        /// As Finding::other_verdicts(), that the rule is younger than the rows, and what rows of other settings say.
        std::string by_other_rules() const;
        std::string at_smaller_scale() const { return smaller ? smaller->by_the_rule() : ""; }
        const std::string& renderer() const { return (judged ? judged : smaller)->evidence.renderer; }
    };
    /// One line for each renderer that either profile has figures of; one line if there are none.
    std::vector<Line> lines() const;
    /// Of the judged ones the one that is told first.
    const Finding& first() const { return *std::ranges::max_element(judged, {}, &Finding::precedence); }
    /// The judged ones first; the varied ones left out.
    std::vector<const Finding*> all() const;
};

/// In the order of the claims.
std::vector<ClaimFindings> find_claims(const RunFolders& folders, const std::string& profile);

}  // namespace radiafit::harness

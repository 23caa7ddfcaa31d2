#pragma once
#include <span>
#include <string>
#include <vector>

#include "finished_run.h"
#include "judgement.h"

/// The paper's claims: for each the code that takes figures from the rows of one run, and the rules of rules.toml that
/// judge them.
namespace radiafit::harness {

/// Throws UserError for rows that lack what it needs.
using Find = Evidence (*)(const FinishedRun& run);

struct Claim {
    std::string id, section, states;
    std::string experiment;  ///< whose rows it is judged from
    Rule rule;               ///< decides
    std::vector<Rule> readings = {}, former = {};
    Find find;
};
/// All, C1 first. Throws std::logic_error for a rules.toml that is not as it says itself, or not of these claims.
const std::vector<Claim>& claims();

struct ClaimCode {
    const char* id;
    Find find;
};
std::span<const ClaimCode> convergence_claims();  ///< how fast, and to which ends, optimizers converge
std::span<const ClaimCode> stopping_claims();     ///< when problems stop
std::span<const ClaimCode> samples_claims();      ///< how pixels reach texels
std::span<const ClaimCode> images_claims();       ///< how good the pictures are
std::span<const ClaimCode> time_claims();         ///< where the time goes
std::span<const ClaimCode> utilization_claims();  ///< what the fragment stage does with it
std::span<const ClaimCode> scale_claims();        ///< how time and memory grow

}  // namespace radiafit::harness

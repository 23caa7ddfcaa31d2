#pragma once
#include <span>
#include <vector>

#include "finished_run.h"
#include "judgement.h"

/// The paper's claims, and for each the rule that judges it from the rows of one run. A rule throws UserError for rows
/// that lack what it needs.
namespace radiafit::harness {

struct Claim {
    const char *id, *section, *states, *rule;
    const char* experiment;  ///< whose rows it is judged from
    Judgement (*judge)(const FinishedRun& run);
};
/// All, C1 first.
const std::vector<Claim>& claims();

std::span<const Claim> convergence_claims();  ///< how fast, and to which ends, optimizers converge
std::span<const Claim> images_claims();       ///< how good the pictures are
std::span<const Claim> time_claims();         ///< where the time goes
std::span<const Claim> utilization_claims();  ///< what the fragment stage does with it
std::span<const Claim> scale_claims();        ///< how time and memory grow

}  // namespace radiafit::harness

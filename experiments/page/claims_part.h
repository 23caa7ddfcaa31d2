#pragma once
#include <span>
#include <string>

#include "claims/findings.h"
#include "page/html.h"

namespace radiafit::harness {

/// How many claims have which verdict, by the runs that are told first.
Html claims_counts(std::span<const ClaimFindings> claims);
/// One line of each claim, by the run that is told first; the verdicts of other machines are folded.
Html claims_summary(std::span<const ClaimFindings> claims);
/// Each claim with its rule, and what every run found.
Html claims_in_full(std::span<const ClaimFindings> claims);
/// The claims that are judged from an experiment's rows, with their verdicts; empty if none are.
Html claims_of(std::span<const ClaimFindings> claims, const std::string& experiment);

}  // namespace radiafit::harness

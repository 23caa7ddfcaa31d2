#pragma once
#include <span>

#include "claims/findings.h"
#include "page/html.h"
#include "report/experiments.h"

namespace radiafit::harness {

/// The runs that the report shows of an experiment: the newest of each device, at the paper's scale first, then of the
/// given profile.
std::vector<RunRecord> shown_runs(const RunFolders& folders, const std::string& experiment, const std::string& profile);

/// Every figure and table, drawn anew from its rows, beside what the paper says and the claims that are judged from it.
/// Where a run lacks something, or it cannot be drawn, a note says so. `scratch`: a folder for temporary files.
Html exhibits_part(const RunFolders& folders, const std::string& profile, std::span<const ClaimFindings> claims,
                   const std::filesystem::path& scratch);

}  // namespace radiafit::harness

#pragma once
#include <span>

#include "page/html.h"
#include "report/finished_runs.h"

namespace radiafit::harness {

/// With what each run was made: machines, compilers and libraries, those that share them together; then a line of each
/// run. Runs are named from `checkout` on.
Html environment_part(std::span<const RunRecord> runs, const std::filesystem::path& checkout);

}  // namespace radiafit::harness

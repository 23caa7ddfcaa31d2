#pragma once
#include <filesystem>
#include <string>

#include "claims/findings.h"
#include "page/html.h"

namespace radiafit::harness {

/// The performance profile of the solvers, from the newest run of `solvers` at the paper's scale and of the profile;
/// where they lack something, a note says so. `scratch`: a folder for temporary files.
Html performance_part(const RunFolders& folders, const std::string& profile, const std::filesystem::path& scratch);

}  // namespace radiafit::harness

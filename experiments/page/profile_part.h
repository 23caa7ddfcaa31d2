#pragma once
#include <filesystem>
#include <string>

#include "claims/findings.h"
#include "page/html.h"

namespace radiafit::harness {

/// The performance profile of the solvers, from the newest run of `solvers` at the paper's scale and of the profile;
/// what they lack is told in its place. `scratch`: a folder for files that go again.
Html performance_part(const RunFolders& folders, const std::string& profile, const std::filesystem::path& scratch);

}  // namespace radiafit::harness

#pragma once
#include <string>

#include "claims/findings.h"
#include "page/html.h"

namespace radiafit::harness {

/// Our solvers and others' on the same problems: times at equal shares of problems that arrive.
Html rivals_part(const RunFolders& folders, const std::string& profile);

}  // namespace radiafit::harness

#pragma once
#include "claims/findings.h"
#include "page/html.h"

namespace radiafit::harness {

/// What differs between the runs that came with the checkout and those of the results, as `radiafit compare` says it.
Html comparison_part(const RunFolders& folders);

}  // namespace radiafit::harness

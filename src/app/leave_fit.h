#pragma once
#include <string>

#include "app/family.h"
#include "base/record.h"

namespace radiafit {

/// Where a fit goes, and what is wanted of it besides.
struct FitTarget {
    std::string out;
    bool covariance = false;  ///< maps of standard deviations
    bool json = false;        ///< what came of it, on standard output
};

/// Checks what a fit came to, writes it and says so. `begun`: its provenance. Throws UserError for a fit that means
/// nothing, and as Fitted::write() does.
void leave(const FitTarget& target, const Dataset& dataset, const FitRequest& request, FinishedFit done,
           const Record& begun);

}  // namespace radiafit

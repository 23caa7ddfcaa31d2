#pragma once
#include <filesystem>
#include <string>

#include "base/record.h"
#include "fitting/family.h"

namespace radiafit::fits {

/// What a fit's record begins with, now: the command, as make_record() takes it, and the dataset.
Record begin_record(const Dataset& dataset, int argc, const char* const* argv);

/// Throws UserError for a fit that means nothing.
void require_result(const FitRecord& fit, const Dataset& dataset);

/// Writes everything that a fit leaves into one folder. `begun`: its provenance. Throws as Fitted::write() does.
void save_fit(const std::filesystem::path& folder, FinishedFit& done, const FitRequest& request, const Record& begun);

/// Where a fit goes, and what else is wanted of it.
struct FitTarget {
    std::string out;
    bool covariance = false;  ///< maps of standard deviations
    bool json = false;        ///< what came of it, on standard output
    bool check = false;       ///< warn where the baseline is better on held-out images (baseline_check.h)
};

/// Checks what a fit came to, writes it and says so. `begun`: its provenance. Throws UserError for a fit that means
/// nothing, and as Fitted::write() does.
void leave(const FitTarget& target, const Dataset& dataset, const FitRequest& request, FinishedFit done,
           const Record& begun);

}  // namespace radiafit::fits

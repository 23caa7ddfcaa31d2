#pragma once
#include <string>
#include <vector>

#include "fitting/fit_options.h"

namespace radiafit::fits {

/// The values of an option that a search goes through, in order, from the one that it begins with.
struct Ladder {
    const char* option;
    std::vector<const char*> values;
    bool (*means_something)(const FitRequest& request) = [](const FitRequest&) { return true; };
};

/// Fits of one model that a search begins with, the model first in each, and where it goes from there.
struct TuneCandidate {
    std::vector<FitSetting> starts;
    std::vector<Ladder> ladders;
};

/// Robust losses, for solvers that take them, and where residuals begin to count less.
std::vector<Ladder> loss_ladders();

}  // namespace radiafit::fits

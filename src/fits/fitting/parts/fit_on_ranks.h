#pragma once
#include <filesystem>
#include <optional>

#include "fitting/family.h"
#include "fitting/parts/ranks.h"

namespace radiafit::fits {

/// A fit on all ranks, each of which calls it: a shard each, in separate folders in `folder`; where OpenGL is used,
/// on a GPU each as far as a machine has them. Returns the fit to rank 0, and nothing to the others. Whatever one of
/// them throws ends all, after one line on standard error.
std::optional<FinishedFit> fit_on_ranks(Ranks& ranks, const Dataset& dataset, const FitRequest& request,
                                        const std::filesystem::path& folder, bool force);

}  // namespace radiafit::fits

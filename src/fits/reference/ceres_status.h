#pragma once
#include "base/rings.h"
#include "model/status.h"

namespace radiafit::fits {

/// From now on a step that fails in Ceres is a status, not a line on the terminal. From any thread.
void silence_ceres();

/// termination: a ceres::TerminationType, whose header is too heavy for ours; USER_SUCCESS is what ends a solve at its
/// residual. `failed`: where no step lowers the cost, or there is no cost.
Status ceres_status(int termination, Status failed);

}  // namespace radiafit::fits

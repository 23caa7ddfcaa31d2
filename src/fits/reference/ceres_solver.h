#pragma once
#include "reference/ceres_options.h"
#include "reference/vertex_runs.h"

namespace radiafit::fits {

/// Ceres on E_t, one problem per vertex and channel: trust region methods over residual blocks (one ceres::Problem per
/// vertex serves its three channels, one after another), line searches over E_t and its gradient.
/// Throws UserError for an unknown setting, and for the paper's penalty, which is no sum of squares.
/// A row's time counts from where Ceres starts the problem, its preprocessing included; what comes before (residual
/// blocks, or copies of the samples) is the run's set-up.
VertexSolver ceres_solver(const LfmOptions& model, const CeresOptions& options);

}  // namespace radiafit::fits

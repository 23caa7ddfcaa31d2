#pragma once
#include <string>

#include "reference/solver_memory.h"
#include "reference/vertex_runs.h"

namespace radiafit::fits {

/// Ceres on E_t, one problem per vertex and channel: trust region methods over residual blocks (one ceres::Problem per
/// vertex serves its three channels, one after another), line searches over E_t and its gradient.
struct CeresSetting {
    const char* name;
    const char* help;
    CeresMemory memory;
};
std::span<const CeresSetting> ceres_settings();
/// Throws UserError for an unknown name.
const CeresSetting& find_ceres_setting(const std::string& name);

struct CeresOptions {
    std::string setting = "lbfgs";  ///< a name in ceres_settings(); the default is the fastest by measurement
    int iterations = 25;
    double stop_residual = 0;  ///< root mean square residual; 0 = off
};

/// Throws UserError for an unknown setting, and for the paper's penalty, which is no sum of squares.
/// A row's time counts from Ceres' own start of the problem, its preprocessing included; what comes before (residual
/// blocks, or copies of the samples) is the run's set-up.
VertexSolver ceres_solver(const LfmOptions& model, const CeresOptions& options);

}  // namespace radiafit::fits

#pragma once
#include <span>
#include <string>

#include "reference/solver_memory.h"

namespace radiafit::fits {

/// One of Ceres' ways to minimize E_t.
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

}  // namespace radiafit::fits

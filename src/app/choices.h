#pragma once
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "app/solve.h"
#include "gl/context.h"

/// Names on the command line and in config files, and what they stand for.
namespace radiafit {

enum class DistributorChoice { cpu, gl };
DistributorChoice choose_distributor(const std::string& name);
TargetSpace choose_space(const std::string& name);
StreamSource choose_source(const std::string& name);
ContextOptions context_options(const FitRequest& request);

}  // namespace radiafit

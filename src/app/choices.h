#pragma once
#include <string>

#include "app/solve.h"
#include "gl/context.h"
#include "gl/fragment_engine.h"

/// Names on the command line and in config files, and what they stand for.
namespace radiafit {

enum class DistributorChoice { cpu, gl };
DistributorChoice choose_distributor(const std::string& name);
TargetSpace choose_space(const std::string& name);
StreamSource choose_source(const std::string& name);
/// Throws UserError unless it is cpu or fragment.
void check_engine(const std::string& name);
RecordKind choose_record(const std::string& name);
Passes choose_passes(const std::string& name);
Storage choose_storage(const std::string& name);
Sums choose_sums(const std::string& name);
ContextOptions context_options(const FitRequest& request);
FragmentOptions fragment_options(const FitRequest& request);

}  // namespace radiafit

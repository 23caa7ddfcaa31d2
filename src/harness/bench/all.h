#pragma once
#include "bench/bundle.h"
#include "bench/options.h"

namespace radiafit::harness {

/// All that a stranger's machine is asked for: agreement and timings of its devices, then the experiments of
/// the bundle, each in a process of its own, in as many minutes as the options say. After each the archive
/// has what there is; one that fails, or crashes with its driver, is told, and the others go on. `program`: this one.
/// Exit status: 1 if any failed.
int measure_all(const BenchOptions& options, const std::string& program, std::span<const BundledExperiment> bundle);

}  // namespace radiafit::harness

#pragma once
#include <span>

#include "base/rings.h"

/// The experiments that radiafit-bench has in it, for machines where nothing is installed (`--all`).
namespace radiafit::harness {

struct BundledExperiment {
    const char* name;
    int (*main)(int argc, const char* const* argv);
    const char* config;  ///< the text of experiments/NAME.toml
};
/// Those that measure what claims about a graphics chip are judged by, in the order in which they are run.
std::span<const BundledExperiment> bundled_experiments();

/// Each is as a program of its own. Exit status.
int fig8_time(int argc, const char* const* argv);
int fig10_utilization(int argc, const char* const* argv);
int streaming(int argc, const char* const* argv);
int scaling(int argc, const char* const* argv);
int passes(int argc, const char* const* argv);

}  // namespace radiafit::harness

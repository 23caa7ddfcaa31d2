#pragma once
#include <string>
#include <vector>

#include "base/rings.h"

/// Performance profiles (Dolan and Moré, Benchmarking optimization software with performance profiles, Mathematical
/// Programming 91, 2002).
namespace radiafit::harness {

/// What one solver took for each problem; solvers to be compared have the same problems at the same places.
struct SolverTimes {
    std::string solver;
    std::vector<double> seconds;  ///< infinite: it did not solve it; NaN: it was not tried
};

/// The share of problems that a solver solved within a factor of the fastest solver's time.
struct PerformanceProfile {
    std::string solver;
    size_t tried = 0;  ///< the problems of which shares are taken
    /// Of the solved ones: its time over the fastest one's, ascending; infinite where only the fastest took no time.
    std::vector<double> ratios;
    double share_within(double factor) const;
};

/// One for each solver, in their order. A problem that no solver solved counts among those tried. Throws
/// std::logic_error for solvers with different numbers of problems, and for times below 0.
std::vector<PerformanceProfile> performance_profiles(const std::vector<SolverTimes>& times);

}  // namespace radiafit::harness

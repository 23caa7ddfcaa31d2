#include "page/performance_profile.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace radiafit::harness {

double PerformanceProfile::share_within(double factor) const {
    return double(std::ranges::upper_bound(ratios, factor) - ratios.begin()) / double(tried);
}

std::vector<PerformanceProfile> performance_profiles(const std::vector<SolverTimes>& times) {
    const size_t problems = times.empty() ? 0 : times.front().seconds.size();
    std::vector<double> fastest(problems, INFINITY);
    for (const SolverTimes& one : times) {
        if (one.seconds.size() != problems) throw std::logic_error("performance_profiles: problems differ");
        for (size_t i = 0; i < problems; ++i) {
            if (one.seconds[i] < 0) throw std::logic_error("performance_profiles: a time below 0");
            fastest[i] = std::fmin(fastest[i], one.seconds[i]);
        }
    }
    std::vector<PerformanceProfile> profiles;
    for (const SolverTimes& one : times) {
        PerformanceProfile& profile = profiles.emplace_back();
        profile.solver = one.solver;
        for (size_t i = 0; i < problems; ++i) {
            profile.tried += !std::isnan(one.seconds[i]);
            if (std::isfinite(one.seconds[i]))
                profile.ratios.push_back(one.seconds[i] == fastest[i] ? 1 : one.seconds[i] / fastest[i]);
        }
        std::ranges::sort(profile.ratios);
    }
    return profiles;
}

}  // namespace radiafit::harness

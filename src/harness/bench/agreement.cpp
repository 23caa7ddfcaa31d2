#include "bench/agreement.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <limits>
#include <stdexcept>

namespace radiafit::harness {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

double distance(double value, const ExactSum& exact) {
    constexpr double least = 1e-37;  // below it 32-bit floats lose digits
    const double difference = std::abs(value - exact.value);
    if (!std::isfinite(difference)) return infinite;
    return difference <= least ? 0 : exact.magnitude > 0 ? difference / exact.magnitude : infinite;
}

/// The largest distance at one site, whose entries are [begin, end).
double worst_of(const std::vector<float>& values, const std::vector<ExactSum>& exact, size_t begin, size_t end) {
    double worst = 0;
    for (size_t i = begin; i < end; ++i) worst = std::max(worst, distance(double(values[i]), exact[i]));
    return worst;
}

void check_sizes(const DeviceSums& sums, const ExactSums& exact) {
    bool same = sums.samples.size() == exact.samples.size();
    for (size_t q = 0; q < quantity_names.size(); ++q) same = same && sums.sums[q].size() == exact.sums[q].size();
    if (!same) throw std::logic_error("sums of different sites or problems cannot be compared");
}

}  // namespace

Agreement compare(const DeviceSums& sums, const ExactSums& exact) {
    check_sizes(sums, exact);
    Agreement found;
    for (size_t site = 0; site < exact.samples.size(); ++site) {
        if (exact.samples[site] == 0 && sums.samples[site] == 0) continue;  // an engine may leave it alone
        ++found.sites;
        found.samples += exact.samples[site];
        if (exact.samples[site] != sums.samples[site]) {
            ++found.other_sites;
            found.other_samples += uint64_t(std::abs(int64_t(exact.samples[site]) - int64_t(sums.samples[site])));
            continue;
        }
        for (size_t q = 0; q < quantity_names.size(); ++q) {
            const bool of_parameters = q == gradient_sum || q == diagonal_sum;
            const size_t problems = exact.sums[q].size() / exact.samples.size();
            const size_t begin = of_parameters ? exact.first_parameter[site] : problems * site;
            const size_t end = of_parameters ? exact.first_parameter[site + 1] : problems * (site + 1);
            if (exact.sums[q].empty()) continue;
            found.worst[q] = std::max(found.worst[q], worst_of(sums.sums[q], exact.sums[q], begin, end));
        }
    }
    return found;
}

std::string Agreement::disagreement() const {
    std::vector<std::string> parts;
    if (double(other_sites) > most_left_out * double(sites))
        parts.push_back(fmt::format("{} of {} vertices or texels took other samples: too few are left to compare",
                                    other_sites, sites));
    for (size_t q = 0; q < worst.size(); ++q)
        if (!(worst[q] <= tolerance))
            parts.push_back(fmt::format("{} off by {:.1e} of its terms' magnitudes", quantity_names[q], worst[q]));
    return fmt::format("{}", fmt::join(parts, ", "));
}

double fit_difference(const std::vector<double>& errors, const std::vector<double>& reference) {
    if (errors.size() != reference.size()) return infinite;
    double worst = 0;
    for (size_t i = 0; i < errors.size(); ++i) {
        const double difference = std::abs(errors[i] - reference[i]) / std::abs(reference[i]);
        worst = std::isfinite(difference) ? std::max(worst, difference) : infinite;
    }
    return worst;
}

}  // namespace radiafit::harness

#include "base/statistics.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>

#include "base/rng.h"

namespace radiafit {

double quantile(std::vector<double> values, double q) {
    if (values.empty()) return std::nan("");
    const double at = q * double(values.size() - 1);
    const auto below = values.begin() + static_cast<ptrdiff_t>(at);
    std::nth_element(values.begin(), below, values.end());
    if (below + 1 == values.end()) return *below;
    const double above = *std::min_element(below + 1, values.end());
    return *below + (at - std::floor(at)) * (above - *below);
}

Interval ratio_of_medians(const std::vector<double>& above, const std::vector<double>& below, double confidence) {
    constexpr int draws = 2000;
    Rng rng(1979);
    std::vector<double> drawn;
    const auto median_of_draw = [&](const std::vector<double>& values) {
        drawn.clear();
        for (size_t i = 0; i < values.size(); ++i) drawn.push_back(values[rng.index(uint32_t(values.size()))]);
        return median(drawn);
    };
    std::vector<double> ratios;
    for (int i = 0; i < draws; ++i) {
        const double numerator = median_of_draw(above);
        ratios.push_back(numerator / median_of_draw(below));
    }
    return {quantile(ratios, 0.5 - 0.5 * confidence), quantile(ratios, 0.5 + 0.5 * confidence)};
}

std::optional<Interval> median_interval(std::vector<double> values, size_t independent) {
    const size_t n = std::min(independent, values.size());
    // The largest rank r, from 1, that P(the median lies below the r-th value of n) <= 2.5 % allows: that is the chance
    // of fewer than r heads in n throws of a coin. Its terms by their logarithms: 2^-n is no number for a large n.
    const auto log_term = [n](size_t k) {
        return std::lgamma(double(n) + 1) - std::lgamma(double(k) + 1) - std::lgamma(double(n - k) + 1) -
               double(n) * std::log(2.0);
    };
    double below = 0;
    size_t rank = 0;
    while (2 * rank < n && (below += std::exp(log_term(rank))) <= 0.025) ++rank;
    if (rank == 0) return std::nullopt;
    const double at = double(rank - 1) / double(n - 1);
    return Interval{quantile(values, at), quantile(values, 1 - at)};
}

std::optional<Interval> share_interval(double share, size_t count) {
    if (count == 0) return std::nullopt;
    constexpr double z = 1.959964;  // of 95 %
    const double n = double(count), scale = 1 / (1 + z * z / n);
    const double middle = scale * (share + z * z / (2 * n));
    const double half = scale * z * std::sqrt(share * (1 - share) / n + z * z / (4 * n * n));
    return Interval{std::max(0.0, middle - half), std::min(1.0, middle + half)};
}

std::optional<Interval> mean_interval(const std::vector<double>& values) {
    // Student's t of 97.5 % for 1, 2, ... degrees of freedom; beyond, that of 10 is the wider one.
    constexpr double t[] = {12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228};
    if (values.size() < 2) return std::nullopt;
    const double n = double(values.size());
    double mean = 0, squares = 0;
    for (const double value : values) mean += value / n;
    for (const double value : values) squares += (value - mean) * (value - mean);
    const double half = t[std::min(values.size() - 2, std::size(t) - 1)] * std::sqrt(squares / (n - 1) / n);
    return Interval{mean - half, mean + half};
}

}  // namespace radiafit

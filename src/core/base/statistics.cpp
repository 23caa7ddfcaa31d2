#include "base/statistics.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <numeric>

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

double median_of_counts(const std::vector<uint64_t>& counts) {
    const uint64_t all = std::accumulate(counts.begin(), counts.end(), uint64_t(0));
    if (all == 0) return std::nan("");
    const auto of_rank = [&](uint64_t rank) {  // from 0
        size_t number = 0;
        for (uint64_t below = counts[0]; below <= rank; below += counts[number]) ++number;
        return double(number);
    };
    return 0.5 * (of_rank((all - 1) / 2) + of_rank(all / 2));
}

Interval bootstrap_interval(const std::function<double(Rng&)>& figure, double confidence) {
    Rng rng(1979);
    std::vector<double> figures(2000);
    for (double& one : figures) one = figure(rng);
    return {quantile(figures, 0.5 - 0.5 * confidence), quantile(figures, 0.5 + 0.5 * confidence)};
}

Interval ratio_of_medians(const std::vector<double>& above, const std::vector<double>& below, double confidence) {
    std::vector<double> drawn;
    const auto median_of_draw = [&](const std::vector<double>& values, Rng& rng) {
        drawn.clear();
        for (size_t i = 0; i < values.size(); ++i) drawn.push_back(values[rng.index(uint32_t(values.size()))]);
        return median(drawn);
    };
    return bootstrap_interval(
        [&](Rng& rng) {
            const double numerator = median_of_draw(above, rng);
            return numerator / median_of_draw(below, rng);
        },
        confidence);
}

namespace {

/// The largest rank r, from 1, at which P(the quantile lies below the r-th value of n) <= chance: that of fewer than r
/// of n values below the quantile, each of which is so with probability q. 0: there is none.
size_t rank_above(double q, size_t n, double chance) {
    // The terms by their logarithms: q^n is no number for a large n.
    const auto log_term = [&](size_t k) {
        return std::lgamma(double(n) + 1) - std::lgamma(double(k) + 1) - std::lgamma(double(n - k) + 1) +
               double(k) * std::log(q) + double(n - k) * std::log1p(-q);
    };
    double below = 0;
    size_t rank = 0;
    while (rank < n && (below += std::exp(log_term(rank))) <= chance) ++rank;
    return rank;
}

}  // namespace

std::optional<Interval> quantile_interval(std::vector<double> values, double q, size_t independent, double confidence) {
    const size_t n = std::min(independent, values.size());
    const double chance = 0.5 * (1 - confidence);
    const size_t low = rank_above(q, n, chance), high = rank_above(1 - q, n, chance);  // high: from the largest
    if (low == 0 || high == 0) return std::nullopt;
    return Interval{quantile(values, double(low - 1) / double(n - 1)),
                    quantile(values, double(n - high) / double(n - 1))};
}

std::optional<Interval> median_interval(std::vector<double> values, size_t independent) {
    return quantile_interval(std::move(values), 0.5, independent);
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

#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

namespace radiafit {
class Rng;

/// The value below which a share q of the values lies, 0 <= q <= 1; between two neighbours in order of size, linearly
/// (Hyndman and Fan 1996, definition 7). Not a number if there are no values.
double quantile(std::vector<double> values, double q);

inline double median(std::vector<double> values) { return quantile(std::move(values), 0.5); }

/// The median of whole numbers, each of which occurs counts[number] times; not a number if there are none.
double median_of_counts(const std::vector<uint64_t>& counts);

struct Interval {
    double low, high;
};

/// Where a figure lies, with this confidence: the percentile bootstrap (Efron 1979), by 2,000 draws and a fixed seed.
/// figure(rng): of values that it draws anew from those at hand.
Interval bootstrap_interval(const std::function<double(Rng&)>& figure, double confidence = 0.95);

/// Of the ratio of two medians, by drawing both sides anew. Neither side empty; all of `below` above 0.
Interval ratio_of_medians(const std::vector<double>& above, const std::vector<double>& below, double confidence = 0.99);

// 95 % intervals.

/// Interval of the median of a distribution, by order statistics, whatever its shape (David and Nagaraja 2003,
/// section 7.1): the values whose ranks the median lies between in at least 95 % of the draws. `independent`: how many
/// of the values are independent of each other, at most all. None for fewer than six.
std::optional<Interval> median_interval(std::vector<double> values, size_t independent);

/// The same of any quantile, at another confidence if need be. None where there are too few values beyond it.
std::optional<Interval> quantile_interval(std::vector<double> values, double q, size_t independent,
                                          double confidence = 0.95);

/// Of a share that was found among so many: Wilson's (1927). None for none.
std::optional<Interval> share_interval(double share, size_t count);

/// Of the mean of normally distributed values: Student's. None for fewer than two.
std::optional<Interval> mean_interval(const std::vector<double>& values);

}  // namespace radiafit

#pragma once
#include <utility>
#include <vector>

namespace radiafit {

/// The value below which a share q of the values lies, 0 <= q <= 1; between two neighbours in order of size, linearly
/// (Hyndman and Fan 1996, definition 7). Not a number if there are no values.
double quantile(std::vector<double> values, double q);

inline double median(std::vector<double> values) { return quantile(std::move(values), 0.5); }

struct Interval {
    double low, high;
};

/// Where the ratio of two medians lies, with this confidence: the percentile bootstrap (Efron 1979), both sides drawn
/// anew 2,000 times, by a fixed seed. Neither side empty; all of `below` above 0.
Interval ratio_of_medians(const std::vector<double>& above, const std::vector<double>& below, double confidence = 0.99);

}  // namespace radiafit

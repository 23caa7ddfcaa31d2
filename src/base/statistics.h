#pragma once
#include <utility>
#include <vector>

namespace radiafit {

/// The value below which a share q of the values lies, 0 <= q <= 1; between two neighbours in order of size, linearly
/// (Hyndman and Fan 1996, definition 7). Not a number if there are no values.
double quantile(std::vector<double> values, double q);

inline double median(std::vector<double> values) { return quantile(std::move(values), 0.5); }

}  // namespace radiafit

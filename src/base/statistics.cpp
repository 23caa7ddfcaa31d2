#include "base/statistics.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

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

}  // namespace radiafit

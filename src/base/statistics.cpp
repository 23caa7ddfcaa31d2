#include "base/statistics.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

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

}  // namespace radiafit

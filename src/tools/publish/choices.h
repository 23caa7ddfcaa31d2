#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace radiafit::tools {

/// What nearly all of the finite numbers above 0 don't exceed; 1 where there are none.
inline double end_of_scale(std::vector<float> numbers) {
    std::erase_if(numbers, [](float n) { return !std::isfinite(n) || n <= 0; });
    if (numbers.empty()) return 1;
    const auto at = numbers.begin() + ptrdiff_t(numbers.size() * 98 / 100);
    std::nth_element(numbers.begin(), at, numbers.end());
    return double(*at);
}

/// `count` of the views at most, evenly spread.
inline std::vector<uint32_t> spread(const std::vector<uint32_t>& views, size_t count) {
    std::vector<uint32_t> out;
    count = std::min(count, views.size());
    for (size_t i = 0; i < count; ++i) out.push_back(views[(2 * i + 1) * views.size() / (2 * count)]);
    return out;
}

}  // namespace radiafit::tools

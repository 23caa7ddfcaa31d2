#pragma once
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace radiafit::tools {

/// x and y of pixels that touch each other, at corners too.
using ConnectedPixels = std::vector<std::pair<int, int>>;

/// The connected parts of what belongs(x, y) in an image of such a size, in the order of their first pixels.
template <class Belongs>
std::vector<ConnectedPixels> connected_pixels(int width, int height, const Belongs& belongs) {
    std::vector<uint8_t> known(size_t(width) * size_t(height), 0);
    std::vector<ConnectedPixels> parts;
    const auto joins = [&](int x, int y) {
        if (x < 0 || y < 0 || x >= width || y >= height) return false;
        uint8_t& seen = known[size_t(y) * size_t(width) + size_t(x)];
        if (seen || !belongs(x, y)) return false;
        seen = 1;
        return true;
    };
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            if (!joins(x, y)) continue;
            ConnectedPixels& part = parts.emplace_back(ConnectedPixels{{x, y}});
            for (size_t i = 0; i < part.size(); ++i) {
                const auto [px, py] = part[i];
                for (int dy = -1; dy <= 1; ++dy)
                    for (int dx = -1; dx <= 1; ++dx)
                        if (joins(px + dx, py + dy)) part.emplace_back(px + dx, py + dy);
            }
        }
    return parts;
}

}  // namespace radiafit::tools

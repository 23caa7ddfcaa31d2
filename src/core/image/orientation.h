#pragma once
#include <cstddef>
#include <utility>
#include <vector>

/// How a camera was held: EXIF's orientation, from 1 (as stored) to 8. Source: EXIF 2.32, tag 274.
namespace radiafit {

/// Whether a picture stands upright with its sides swapped.
inline bool swaps_sides(int orientation) { return orientation >= 5; }

/// Row and column where the upright picture's pixel (x, y) is stored, in a picture of width x height as stored.
struct StoredPlace {
    size_t x, y;
};
inline StoredPlace stored_place(int orientation, size_t x, size_t y, size_t width, size_t height) {
    if (swaps_sides(orientation)) std::swap(x, y);
    const bool right = orientation == 2 || orientation == 3 || orientation == 7 || orientation == 8;
    const bool below = orientation == 3 || orientation == 4 || orientation == 6 || orientation == 7;
    return {right ? width - 1 - x : x, below ? height - 1 - y : y};
}

/// [height][width][channels], as stored, turned upright.
template <class Value>
std::vector<Value> turn_upright(const std::vector<Value>& stored, int orientation, size_t width, size_t height,
                                size_t channels) {
    std::vector<Value> upright(stored.size());
    if (stored.empty()) return upright;
    const size_t wide = swaps_sides(orientation) ? height : width, high = swaps_sides(orientation) ? width : height;
    for (size_t y = 0; y < high; ++y)
        for (size_t x = 0; x < wide; ++x) {
            const StoredPlace from = stored_place(orientation, x, y, width, height);
            for (size_t c = 0; c < channels; ++c)
                upright[(y * wide + x) * channels + c] = stored[(from.y * width + from.x) * channels + c];
        }
    return upright;
}

}  // namespace radiafit

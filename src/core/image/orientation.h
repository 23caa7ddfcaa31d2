#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

/// How a camera was held: EXIF's orientation, from 1 (as stored) to 8. Source: EXIF 2.32, tag 274.
namespace radiafit {

/// Whether a picture stands upright with its sides swapped.
inline bool swaps_sides(int orientation) { return orientation >= 5; }

/// The value of one entry in the first directory of a TIFF or BigTIFF, which is what EXIF data are, too.
struct TiffValue {
    std::string_view bytes;  ///< of all its numbers
    int size = 1;            ///< bytes of a number
    bool big_endian = false;
};

/// Nothing where there is no such entry, or it lies beyond the end: of what the pixels do not need, damage is no
/// reason to refuse a picture. `directory`: where another one than the first begins.
std::optional<TiffValue> find_tiff_value(std::string_view tiff, uint16_t tag, std::optional<uint64_t> directory = {});

/// The orientation in a TIFF's first directory; 1 where it says nothing, or nothing that exists.
int tiff_orientation(std::string_view tiff);

/// Whether EXIF data say that colours are Adobe RGB (1998): interoperability index R03. Source: EXIF 2.32, 4.6.7;
/// DCF 2.0.
bool exif_says_adobe_rgb(std::string_view exif);

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

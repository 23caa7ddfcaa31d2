#pragma once
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

namespace radiafit {

/// Every channel of a picture as its file stores them, row 0 on top.
struct RawImage {
    int width = 0, height = 0;  ///< pixels
    int channels = 0;           ///< the alpha channel included
    int alpha = -1;             ///< index of the alpha channel, or -1
    bool linear = false;        ///< the file says that 16-bit values are linear
    std::variant<std::vector<uint8_t>, std::vector<uint16_t>, std::vector<float>>
        values;  ///< [height][width][channels]

    std::vector<std::string> names = {};  ///< of the channels, where the format has names (OpenEXR); else empty

    int colors() const { return channels - (alpha >= 0 ? 1 : 0); }
    /// Index of colour channel c among all.
    int color(int c) const { return alpha >= 0 && c >= alpha ? c + 1 : c; }
};

}  // namespace radiafit

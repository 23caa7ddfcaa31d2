#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

/// The only user of libwebp.
namespace radiafit {

struct ByteRaster {
    int width = 0, height = 0, channels = 3;  ///< 3: RGB; 4: RGBA, colours not premultiplied
    std::vector<uint8_t> bytes;               ///< [height][width][channels], row 0 on top
};

inline constexpr int largest_webp_side = 16383;

/// Every byte comes back. Throws UserError for an image wider or higher than the format has.
std::string lossless_webp(const ByteRaster& image);
/// quality: 0 to 100; an alpha channel loses nothing, and colours below it stay. Throws as lossless_webp().
std::string lossy_webp(const ByteRaster& image, float quality);
/// RGB. Throws SystemError for bytes that are no WebP.
ByteRaster read_webp(std::string_view bytes);

}  // namespace radiafit

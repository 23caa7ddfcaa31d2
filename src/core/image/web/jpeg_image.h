#pragma once
#include <cstdint>
#include <string>
#include <vector>

/// The only user of libjpeg.
namespace radiafit {

inline constexpr int largest_jpeg_side = 65500;

/// [height][width][3] bytes as a JPEG file's, every channel at every pixel. quality: 1 to 100. Throws UserError for an
/// image wider or higher than the format has, SystemError where libjpeg fails.
std::string jpeg_bytes(int width, int height, const std::vector<uint8_t>& rgb, int quality);

}  // namespace radiafit

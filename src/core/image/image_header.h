#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "image/color_tags.h"

/// What a picture says about itself, read before a library sees it and before anyone takes memory for its pixels.
namespace radiafit {

struct ImageFormat;

inline constexpr uint64_t largest_image_side = 32768;  ///< pixels; beyond any camera

struct ImageHeader {
    uint64_t width = 0, height = 0;       ///< pixels
    uint64_t bits_per_pixel = 0;          ///< stored, all channels together
    const ImageFormat* format = nullptr;  ///< set by read_image_header
    uint64_t stored_pixels = 0;           ///< those of the picture that the file holds; 0: all
    int orientation = 1;                  ///< EXIF's (image/orientation.h)
    ColorTags colors = {};
    std::vector<std::string> remarks = {};  ///< what of the file is left out or filled up, a few words each
};

/// Recognized by content, not by name. Throws UserError that names file and cure: another format than those of
/// image_format.h, a header that is malformed, a side of 0 or above largest_image_side, more pixels than the file's
/// bytes can hold, and kinds that no capture needs (see codecs.h).
ImageHeader read_image_header(const std::filesystem::path& file, std::string_view bytes);

/// Throws UserError: "truncated or corrupt image"; of `why`, the first line.
[[noreturn]] void fail_damaged_image(const std::filesystem::path& file, const std::string& why);

}  // namespace radiafit

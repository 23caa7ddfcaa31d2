#pragma once
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "image/image_header.h"
#include "image/raw_image.h"

namespace radiafit {

/// Bytes that all files of a kind have at one place.
struct FileMark {
    std::string_view bytes;
    size_t at = 0;
    bool in(std::string_view file) const { return file.size() > at && file.substr(at).starts_with(bytes); }
};

/// A kind of picture files.
struct ImageFormat {
    const char* name;                       ///< as messages have it
    std::vector<std::string_view> endings;  ///< of file names, in small letters
    std::vector<FileMark> marks;            ///< any of which identifies it; none: known, but not read
    bool photograph = false;                ///< a calibration may leave this ending out of a photograph's name
    bool colmap = false;  ///< photographs of it may go through COLMAP: datasets/scripts/capture.sh counts them
    bool lossy = false;   ///< stored values differ from those that were written
    ImageHeader (*read_header)(const std::filesystem::path& file, std::string_view bytes) = nullptr;
    RawImage (*read_pixels)(const std::filesystem::path& file, std::string bytes, const ImageHeader& header) = nullptr;
};

/// All of them. The order is that in which endings are tried, and in which messages name them.
std::span<const ImageFormat> image_formats();

/// The format of a file name's ending, in whatever letters; null: of none.
const ImageFormat* format_of_name(const std::filesystem::path& file);

}  // namespace radiafit

#pragma once
#include <filesystem>
#include <string>
#include <string_view>

#include "capture/image_header.h"

namespace radiafit::tools {

/// Walks a TIFF's first directory. Throws UserError that names the cure unless offsets, counts and the sizes of all
/// strips or tiles lie within the file and the picture is plain: grey or RGB, perhaps with an alpha channel, of 8 or 16
/// bits or floats, stored as it is or packed by LZW, deflate or PackBits.
ImageHeader read_tiff_header(const std::filesystem::path& file, std::string_view bytes);

/// The file with nothing in its first directory but what the pixels need, and no second one. A TIFF's other entries
/// (comments, profiles, nested directories) may point anywhere, and libraries follow them.
std::string plain_tiff(const std::filesystem::path& file, std::string bytes);

}  // namespace radiafit::tools

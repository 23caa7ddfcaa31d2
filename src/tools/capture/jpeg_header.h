#pragma once
#include <filesystem>
#include <string_view>

#include "capture/image_header.h"

namespace radiafit::tools {

/// Walks a JPEG's segments to the frame's header. Throws UserError for a file that ends before, for other depths than 8
/// bits, and for other than one or three channels.
ImageHeader read_jpeg_header(const std::filesystem::path& file, std::string_view bytes);

}  // namespace radiafit::tools

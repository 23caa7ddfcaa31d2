#pragma once
#include <filesystem>
#include <string_view>

#include "capture/image_header.h"

namespace radiafit::tools {

/// Walks the attributes of an OpenEXR file. Throws UserError for a file that ends before their end, for one without
/// data window or channels, and for several or deep pictures in one file.
ImageHeader read_exr_header(const std::filesystem::path& file, std::string_view bytes);

}  // namespace radiafit::tools

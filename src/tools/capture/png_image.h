#pragma once
#include <filesystem>
#include <string_view>

#include "capture/image_header.h"
#include "capture/raw_image.h"

namespace radiafit::tools {

/// Walks a PNG's chunks first. Throws UserError for lengths beyond the file and checksums that differ.
ImageHeader read_png_header(const std::filesystem::path& file, std::string_view bytes);

/// The pixels by libpng, which prints nothing: palettes and what has fewer than 8 bits become 8 bits, transparency an
/// alpha channel. Call it after read_png_header. Throws UserError for data that are no picture.
RawImage read_png_pixels(const std::filesystem::path& file, std::string_view bytes);

}  // namespace radiafit::tools

#pragma once
#include <filesystem>
#include <string_view>

#include "capture/image_header.h"
#include "capture/raw_image.h"

namespace radiafit::tools {

/// PFM: "PF" (three channels) or "Pf" (one), width, height and scale as text, # comments between them; then floats,
/// rows from bottom to top, big-endian where the scale is positive. Throws UserError for a header that is malformed.
ImageHeader read_pfm_header(const std::filesystem::path& file, std::string_view bytes);

/// Values times the scale's size. Throws UserError likewise, and for a file that ends before its last pixel.
RawImage read_pfm_pixels(const std::filesystem::path& file, std::string_view bytes);

}  // namespace radiafit::tools

#pragma once
#include <filesystem>
#include <string>

#include "capture/image_header.h"
#include "capture/raw_image.h"

namespace radiafit::tools {

/// The pixels of a JPEG, TIFF or OpenEXR file by OpenImageIO; colours are never multiplied by alpha. `header` is what
/// read_image_header found in the same bytes. Throws UserError for data that are no picture, or another one than the
/// header describes, and for channels that are neither 8 or 16 bits nor floats.
RawImage read_oiio_pixels(const std::filesystem::path& file, std::string bytes, const ImageHeader& header);

}  // namespace radiafit::tools

#pragma once
#include <filesystem>
#include <string>
#include <string_view>

#include "image/image_header.h"
#include "image/raw_image.h"

/// What reads each format, for the table in image_format.cpp. A header is read first, from the same bytes; what is said
/// there of its errors is beyond what read_image_header() checks of all. All throw UserError that names file and cure.
namespace radiafit {

/// Walks a PNG's chunks: refuses lengths beyond the file and checksums that differ.
ImageHeader read_png_header(const std::filesystem::path& file, std::string_view bytes);
/// By libpng, which prints nothing: palettes and what has fewer than 8 bits become 8 bits, transparency an alpha
/// channel.
RawImage read_png_pixels(const std::filesystem::path& file, std::string bytes, const ImageHeader& header);

/// Walks a JPEG's segments to the frame's header: refuses a file that ends before, other depths than 8 bits, and other
/// than one or three channels.
ImageHeader read_jpeg_header(const std::filesystem::path& file, std::string_view bytes);

/// Walks a TIFF's or BigTIFF's first directory: refuses it unless offsets, counts and the sizes of all strips or tiles
/// lie within the file and the picture is plain: grey or RGB, perhaps with an alpha channel, of 8 or 16 bits or floats,
/// or a palette of 8 bits, stored as it is or packed by LZW, deflate, PackBits, Zstandard or JPEG. Previews and
/// cameras' raw files are refused by name.
ImageHeader read_tiff_header(const std::filesystem::path& file, std::string_view bytes);
/// By OpenImageIO, of a file with nothing in its first directory but what the pixels need, and no second one. A TIFF's
/// other entries (comments, profiles, nested directories) may point anywhere, and libraries follow them.
RawImage read_tiff_pixels(const std::filesystem::path& file, std::string bytes, const ImageHeader& header);

/// Walks an OpenEXR file's attributes (exr_header.h): refuses a file that ends before their end, one without data
/// window or channels, tiles above 2048 pixels, several or deep pictures in one file, channels of fewer pixels, and
/// channels of which none are R, G, B or grey. The picture is the display window.
ImageHeader read_exr_header(const std::filesystem::path& file, std::string_view bytes);
/// R, G, B, and A if the file has it, of the one layer that has them. What of the display window lies outside the data
/// window was not rendered: it is 0 in all channels, and alpha is added to say so. What of the data window lies outside
/// the display window is left out.
RawImage read_exr_pixels(const std::filesystem::path& file, std::string bytes, const ImageHeader& header);

/// PFM: "PF" (three channels) or "Pf" (one), width, height and scale as text, # comments between them; then floats,
/// rows from bottom to top, big-endian where the scale is positive.
ImageHeader read_pfm_header(const std::filesystem::path& file, std::string_view bytes);
/// Values times the scale's size.
RawImage read_pfm_pixels(const std::filesystem::path& file, std::string bytes, const ImageHeader& header);

/// By libheif, which knows the boxes of HEIC, HEIF and AVIF: the primary picture, upright. Refuses pictures of high
/// dynamic range and colours multiplied by alpha.
ImageHeader read_heif_header(const std::filesystem::path& file, std::string_view bytes);
/// Of more than 8 bits: 16, spread over their range.
RawImage read_heif_pixels(const std::filesystem::path& file, std::string bytes, const ImageHeader& header);

/// By OpenImageIO's reader of that name; colours are never multiplied by alpha. Refuses data that are no picture, or
/// another one than the header describes, and channels that are neither 8 or 16 bits nor floats.
RawImage read_oiio_pixels(const std::filesystem::path& file, std::string_view bytes, const ImageHeader& header,
                          const char* reader);

}  // namespace radiafit

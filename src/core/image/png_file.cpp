#include "image/png_file.h"

#include <fmt/format.h>
#include <png.h>
#include <zlib.h>

#include <string>

#include "base/atomic_file.h"
#include "base/error.h"

namespace radiafit {
namespace {

std::string big_endian(uint32_t x) { return {char(x >> 24), char(x >> 16), char(x >> 8), char(x)}; }

/// PNG specification, Section 11.3.4.3.
std::string text_chunk(std::string_view keyword, std::string_view text) {
    const std::string content = fmt::format("tEXt{}{}{}", keyword, '\0', text);
    const uLong checksum = crc32_z(0, reinterpret_cast<const Bytef*>(content.data()), content.size());
    return big_endian(uint32_t(content.size() - 4)) + content + big_endian(uint32_t(checksum));
}

/// values: [height][width][channels of the format].
std::string encoded(int width, int height, png_uint_32 format, const void* values, std::string_view software) {
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    image.width = png_uint_32(width);
    image.height = png_uint_32(height);
    image.format = format;
    std::string bytes(PNG_IMAGE_PNG_SIZE_MAX(image), '\0');
    png_alloc_size_t size = bytes.size();
    if (!png_image_write_to_memory(&image, bytes.data(), &size, 0, values, 0, nullptr))
        throw SystemError(fmt::format("libpng cannot make a PNG of {} x {} pixels: {}", width, height, image.message));
    bytes.resize(size);
    constexpr size_t header_end = 33;  // signature and IHDR
    if (!software.empty()) bytes.insert(header_end, text_chunk("Software", software));
    return bytes;
}

size_t pixels_of(int width, int height) { return width < 1 || height < 1 ? 0 : size_t(width) * size_t(height); }

}  // namespace

std::string png_bytes(int width, int height, const std::vector<uint8_t>& bytes8, std::string_view software) {
    const size_t pixels = pixels_of(width, height);
    if (pixels == 0 || (bytes8.size() != 3 * pixels && bytes8.size() != 4 * pixels))
        throw SystemError(fmt::format("a PNG of {} x {} pixels was given {} bytes", width, height, bytes8.size()));
    const auto format = bytes8.size() == 4 * pixels ? PNG_FORMAT_RGBA : PNG_FORMAT_RGB;  // sRGB, and marked as such
    return encoded(width, height, format, bytes8.data(), software);
}

std::string grey16_png_bytes(int width, int height, const std::vector<uint16_t>& values, std::string_view software) {
    const size_t pixels = pixels_of(width, height);
    if (pixels == 0 || values.size() != pixels)
        throw SystemError(fmt::format("a PNG of {} x {} pixels was given {} values", width, height, values.size()));
    return encoded(width, height, PNG_FORMAT_LINEAR_Y, values.data(), software);
}

void write_png(const std::filesystem::path& file, int width, int height, const std::vector<uint8_t>& bytes8,
               std::string_view software) {
    write_file(file, png_bytes(width, height, bytes8, software));
}

}  // namespace radiafit

#include "capture/png_file.h"

#include <fmt/format.h>
#include <png.h>

#include <string>

#include "base/atomic_file.h"
#include "base/error.h"

namespace radiafit {

void write_png(const std::filesystem::path& file, int width, int height, const std::vector<uint8_t>& rgb8) {
    if (width < 1 || height < 1 || rgb8.size() != size_t(width) * size_t(height) * 3)
        throw SystemError(
            fmt::format("write_png({}): {} bytes for {} x {} pixels", file.string(), rgb8.size(), width, height));
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    image.width = png_uint_32(width);
    image.height = png_uint_32(height);
    image.format = PNG_FORMAT_RGB;  // sRGB, and marked as such
    std::string bytes(PNG_IMAGE_PNG_SIZE_MAX(image), '\0');
    png_alloc_size_t size = bytes.size();
    if (!png_image_write_to_memory(&image, bytes.data(), &size, 0, rgb8.data(), 0, nullptr))
        throw SystemError(fmt::format("libpng cannot make {}: {}", file.string(), image.message));
    write_file(file, {bytes.data(), size});
}

}  // namespace radiafit

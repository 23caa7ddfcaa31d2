#include <fmt/format.h>

#include "base/error.h"
#include "image/codecs.h"
#include "image/module.h"
#include "image/oiio/read_pixels.h"

namespace radiafit {

RawImage read_oiio_pixels(const std::filesystem::path& file, std::string_view bytes, const ImageHeader& header,
                          const char* reader) {
    static ReadOiioPixels* const read = load_function<ReadOiioPixels>(
        oiio_module, oiio_function,
        "JPEG, TIFF and OpenEXR pictures cannot be read ({}): install libopenimageio-dev and build radiafit again, or "
        "convert them to PNG");
    OiioPixels pixels;
    read(file.filename().string(), bytes, header, reader, pixels);
    if (!pixels.failure.empty()) throw SystemError(pixels.failure);
    if (pixels.damage) fail_damaged_image(file, *pixels.damage);
    if (!pixels.channel_type.empty())
        throw UserError(
            fmt::format("{}: channels are of type {}, neither 8 or 16 bits nor float: convert the image to PNG",
                        file.string(), pixels.channel_type));
    return std::move(pixels.image);
}

}  // namespace radiafit

#include "image/web/webp_image.h"

#include <fmt/format.h>
#include <webp/decode.h>
#include <webp/encode.h>

#include <memory>
#include <stdexcept>

#include "base/error.h"

namespace radiafit {
namespace {

std::string encoded(const ByteRaster& image, const WebPConfig& config) {
    if (image.width > largest_webp_side || image.height > largest_webp_side)
        throw UserError(
            fmt::format("an image of {} x {} pixels is too large for a page, {} a side is the most; fit with "
                        "a smaller surface side or a coarser mesh",
                        image.width, image.height, largest_webp_side));
    WebPPicture picture;
    if (!WebPPictureInit(&picture)) throw SystemError("WebPPictureInit failed: another version of libwebp");
    picture.use_argb = 1;
    picture.width = image.width;
    picture.height = image.height;
    WebPMemoryWriter written;
    WebPMemoryWriterInit(&written);
    picture.writer = WebPMemoryWrite;
    picture.custom_ptr = &written;
    const int row = image.width * image.channels;
    const bool done = (image.channels == 4 ? WebPPictureImportRGBA(&picture, image.bytes.data(), row)
                                           : WebPPictureImportRGB(&picture, image.bytes.data(), row)) &&
                      WebPEncode(&config, &picture);
    const int error = picture.error_code;
    std::string out(reinterpret_cast<const char*>(written.mem), done ? written.size : 0);
    WebPMemoryWriterClear(&written);
    WebPPictureFree(&picture);
    if (!done) throw SystemError(fmt::format("WebPEncode failed with error {}", error));
    return out;
}

}  // namespace

std::string lossless_webp(const ByteRaster& image) {
    WebPConfig config;
    constexpr int effort = 3;  // of 9; more gains 3 % on noise-like maps and takes thrice as long
    if (!WebPConfigInit(&config) || !WebPConfigLosslessPreset(&config, effort))
        throw SystemError("WebPConfigLosslessPreset failed");
    config.exact = 1;
    return encoded(image, config);
}

std::string lossy_webp(const ByteRaster& image, float quality) {
    WebPConfig config;
    if (!WebPConfigPreset(&config, WEBP_PRESET_PHOTO, quality)) throw SystemError("WebPConfigPreset failed");
    config.exact = 1;
    config.use_sharp_yuv = 1;
    return encoded(image, config);
}

ByteRaster read_webp(std::string_view bytes) {
    ByteRaster out;
    const std::unique_ptr<uint8_t, decltype(&WebPFree)> pixels(
        WebPDecodeRGB(reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size(), &out.width, &out.height), WebPFree);
    if (!pixels) throw SystemError("WebPDecodeRGB failed");
    out.bytes.assign(pixels.get(), pixels.get() + 3 * size_t(out.width) * size_t(out.height));
    return out;
}

}  // namespace radiafit

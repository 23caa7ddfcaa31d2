#include "capture/image_header.h"

#include <fmt/format.h>

#include "base/error.h"
#include "capture/byte_reader.h"
#include "capture/exr_header.h"
#include "capture/jpeg_header.h"
#include "capture/pfm_image.h"
#include "capture/png_image.h"
#include "capture/tiff_header.h"

namespace radiafit::tools {
namespace {

using namespace std::string_view_literals;

// Deflate makes 1,032 bytes of one at most, LZW 1,365, and a JPEG of blank blocks some 1,400. A header that promises
// more than this lies about the picture, and must not decide how much memory is taken. Small files have their headers'
// worth of slack.
constexpr uint64_t largest_ratio = 2000, slack_bytes = uint64_t(1) << 20;

ImageHeader read_known(const std::filesystem::path& file, std::string_view bytes) {
    if (bytes.starts_with("\x89PNG"sv)) return read_png_header(file, bytes);
    if (bytes.starts_with("\xff\xd8"sv)) return read_jpeg_header(file, bytes);
    if (bytes.starts_with("II*\0"sv) || bytes.starts_with("MM\0*"sv)) return read_tiff_header(file, bytes);
    if (bytes.starts_with("\x76\x2f\x31\x01"sv)) return read_exr_header(file, bytes);
    if (bytes.starts_with("PF"sv) || bytes.starts_with("Pf"sv)) return read_pfm_header(file, bytes);
    if (bytes.empty()) fail_damaged_image(file, "the file has no bytes");
    throw UserError(
        fmt::format("{}: neither PNG, JPEG, TIFF, OpenEXR nor PFM, or its first bytes are corrupt: convert "
                    "the image to PNG",
                    file.string()));
}

}  // namespace

ImageHeader read_image_header(const std::filesystem::path& file, std::string_view bytes) {
    const ImageHeader header = read_known(file, bytes);
    if (header.width < 1 || header.height < 1 || header.width > largest_image_side ||
        header.height > largest_image_side)
        throw UserError(fmt::format("{}: {} x {} pixels; sides run from 1 to {}: scale the image", file.string(),
                                    header.width, header.height, largest_image_side));
    const uint64_t promised = header.width * header.height * header.bits_per_pixel / 8;
    if (promised > largest_ratio * bytes.size() + slack_bytes)
        fail_damaged_image(
            file, fmt::format("{} bytes cannot hold {} x {} pixels", bytes.size(), header.width, header.height));
    return header;
}

void fail_damaged_image(const std::filesystem::path& file, const std::string& why) {
    throw UserError(fmt::format("{}: truncated or corrupt image ({}): copy or export it again", file.string(),
                                why.empty() ? "it cannot be read whole" : why.substr(0, why.find('\n'))));
}

}  // namespace radiafit::tools

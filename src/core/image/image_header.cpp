#include "image/image_header.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.h"
#include "image/image_format.h"
#include "image/other_kinds.h"

namespace radiafit {
namespace {

// Deflate makes 1,032 bytes of one at most, LZW 1,365, and a JPEG of blank blocks some 1,400. A header that promises
// more than this lies about the picture, and must not decide how much memory is taken. Small files have their headers'
// worth of slack.
constexpr uint64_t largest_ratio = 2000, slack_bytes = uint64_t(1) << 20;

const ImageFormat& find_format(const std::filesystem::path& file, std::string_view bytes) {
    if (bytes.empty()) fail_damaged_image(file, "the file has no bytes");
    std::string known;
    for (const ImageFormat& format : image_formats()) {
        if (std::ranges::any_of(format.marks, [&](const FileMark& mark) { return mark.in(bytes); })) return format;
        if (!format.marks.empty()) known += (known.empty() ? "" : ", ") + std::string(format.name);
    }
    known.replace(known.rfind(","), 1, " nor");
    if (const OtherKind* other = find_other_kind(bytes))
        throw UserError(fmt::format("{}: {}, which is not read: {}", file.string(), other->name, other->cure));
    throw UserError(
        fmt::format("{}: neither {}, or its first bytes are corrupt: convert the image to PNG", file.string(), known));
}

}  // namespace

ImageHeader read_image_header(const std::filesystem::path& file, std::string_view bytes) {
    const ImageFormat& format = find_format(file, bytes);
    ImageHeader header = format.read_header(file, bytes);
    header.format = &format;
    if (header.width < 1 || header.height < 1 || header.width > largest_image_side ||
        header.height > largest_image_side)
        throw UserError(fmt::format("{}: {} x {} pixels; sides run from 1 to {}: scale the image", file.string(),
                                    header.width, header.height, largest_image_side));
    const uint64_t pixels = header.stored_pixels ? header.stored_pixels : header.width * header.height;
    const uint64_t promised = pixels * header.bits_per_pixel / 8;
    if (promised > largest_ratio * bytes.size() + slack_bytes)
        fail_damaged_image(
            file, fmt::format("{} bytes cannot hold {} x {} pixels", bytes.size(), header.width, header.height));
    return header;
}

void fail_damaged_image(const std::filesystem::path& file, const std::string& why) {
    throw UserError(fmt::format("{}: truncated or corrupt image ({}): copy or export it again", file.string(),
                                why.empty() ? "it cannot be read whole" : why.substr(0, why.find('\n'))));
}

}  // namespace radiafit

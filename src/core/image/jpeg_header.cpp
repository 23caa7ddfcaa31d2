#include <fmt/format.h>

#include "base/error.h"
#include "image/byte_reader.h"
#include "image/codecs.h"

namespace radiafit {
namespace {

/// Whether the marker is a start of frame: C0 to CF but for the three tables (DHT, JPG, DAC) that lie among them.
bool is_frame(uint64_t marker) {
    return marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc;
}

/// Offset of the frame header's length.
uint64_t find_frame(const ByteReader& reader) {
    for (uint64_t at = 2;;) {
        if (reader.number(at, 1) != 0xff) reader.fail("a JPEG segment does not begin where the one before ends");
        while (reader.number(at, 1) == 0xff) ++at;  // fill bytes
        const uint64_t marker = reader.number(at++, 1);
        if (is_frame(marker)) return at;
        if (marker == 0xda || marker == 0xd9) reader.fail("no JPEG frame before its data");
        const uint64_t length = reader.number(at, 2);
        if (length < 2) reader.fail("a JPEG segment is too short");
        at += length;
    }
}

}  // namespace

ImageHeader read_jpeg_header(const std::filesystem::path& file, std::string_view bytes) {
    const ByteReader reader(file, bytes, ByteReader::Order::big_endian);
    const uint64_t frame = find_frame(reader) + 2;
    const uint64_t depth = reader.number(frame, 1), channels = reader.number(frame + 5, 1);
    if (depth != 8)
        throw UserError(fmt::format("{}: a JPEG of {} bits: convert the image to PNG", file.string(), depth));
    if (channels != 1 && channels != 3)
        throw UserError(fmt::format("{}: has {} colour channels, neither grey nor RGB: convert the image to RGB",
                                    file.string(), channels));
    return {reader.number(frame + 3, 2), reader.number(frame + 1, 2), 8 * channels};
}

}  // namespace radiafit

#include "capture/exr_header.h"

#include <fmt/format.h>

#include "base/error.h"
#include "base/exr_attribute.h"
#include "capture/byte_reader.h"

namespace radiafit::tools {
namespace {

constexpr uint64_t longest_name = 255;
constexpr uint64_t largest_tile = 2048;  // pixels a side; OpenEXR takes memory for whole tiles

/// A text that a zero byte ends; `at` moves behind it.
std::string_view take_text(const ByteReader& reader, uint64_t& at) {
    const uint64_t begin = at;
    while (reader.number(at, 1) != 0)
        if (++at - begin > longest_name) reader.fail("an OpenEXR name does not end");
    return reader.text(begin, at++ - begin);
}

/// Bits per pixel of a channel list: names, each with 16 bytes that begin with the type.
uint64_t count_bits(const ByteReader& reader, uint64_t at) {
    uint64_t bits = 0;
    while (!take_text(reader, at).empty()) {
        bits += reader.number(at, 4) == 1 ? 16 : 32;  // half; unsigned or float
        at += 16;
    }
    return bits;
}

/// Pixels from one bound of a box to the other, as signed numbers of 32 bits.
uint64_t side(const ByteReader& reader, uint64_t low, uint64_t high) {
    const auto to_signed = [&](uint64_t at) { return int64_t(int32_t(uint32_t(reader.number(at, 4)))); };
    const int64_t pixels = to_signed(high) - to_signed(low) + 1;
    return pixels > 0 ? uint64_t(pixels) : 0;
}

}  // namespace

ImageHeader read_exr_header(const std::filesystem::path& file, std::string_view bytes) {
    const ByteReader reader(file, bytes, ByteReader::Order::little_endian);
    constexpr uint64_t deep = 1 << 11, multipart = 1 << 12;
    if (reader.number(4, 4) & (deep | multipart))
        throw UserError(fmt::format("{}: holds several or deep pictures: export one plain picture", file.string()));
    ImageHeader header{ImageFormat::exr, 0, 0, 0};
    bool sized = false;
    for (uint64_t at = 8;;) {
        const std::string_view name = take_text(reader, at);
        if (name.empty()) break;
        const std::string_view type = take_text(reader, at);
        const uint64_t size = reader.number(at, 4);
        at += 4;
        if (!exr_attribute_fits(type, reader.text(at, size))) reader.fail("an OpenEXR attribute is damaged");
        if (name == "channels" && type == "chlist") header.bits_per_pixel = count_bits(reader, at);
        if (name == "tiles" && (reader.number(at, 4) > largest_tile || reader.number(at + 4, 4) > largest_tile))
            reader.fail("tiles larger than 2048 pixels");
        if (name == "dataWindow" && type == "box2i") {
            if (sized) reader.fail("two data windows");
            header.width = side(reader, at, at + 8);
            header.height = side(reader, at + 4, at + 12);
            sized = true;
        }
        at += size;
    }
    if (!sized || header.bits_per_pixel == 0) reader.fail("an OpenEXR header without data window or channels");
    return header;
}

}  // namespace radiafit::tools

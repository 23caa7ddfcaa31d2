#include <fmt/format.h>

#include "image/codecs.h"
#include "image/exif.h"
#include "image/tiff_directory.h"

namespace radiafit {
namespace {

constexpr std::string_view jpeg_begin = "\xff\xd8", jpeg_end = "\xff\xd9";

/// What a decoder has to know before it sees a piece's pixels: that its colours are, or are not, luma and chroma. The
/// pieces themselves do not say it. Source: T.872, 6.5.3.
std::string adobe_marker(bool luma_chroma) {
    return std::string(
               "\xff\xee\0\x0e"
               "Adobe\0\x64\0\0\0\0",
               15) +
           (luma_chroma ? '\1' : '\0');
}

}  // namespace

RawImage read_tiff_jpegs(const std::filesystem::path& file, std::string_view bytes, const ImageHeader& header) {
    const ByteReader reader = open_tiff(file, bytes);
    const TiffDirectory directory(reader);
    const size_t width = header.width, height = header.height, channels = directory.value(samples_per_pixel, 1);
    const bool tiled = directory.has(tile_offsets);
    const size_t wide = tiled ? directory.value(tile_width) : width;
    const size_t high =
        tiled ? directory.value(tile_length) : std::min(directory.value(rows_per_strip, height), header.height);
    const auto& places = directory.numbers(tiled ? tile_offsets : strip_offsets);
    const auto& sizes = directory.numbers(tiled ? tile_byte_counts : strip_byte_counts);

    std::string head(jpeg_begin);
    if (channels == 3) head += adobe_marker(directory.value(photometric) == 6);
    constexpr uint16_t jpeg_tables = 347;
    if (const auto tables = find_tiff_value(bytes, jpeg_tables)) {
        std::string_view content = tables->bytes;
        if (!content.starts_with(jpeg_begin)) reader.fail("its JPEG tables are damaged");
        content.remove_prefix(jpeg_begin.size());
        if (content.ends_with(jpeg_end)) content.remove_suffix(jpeg_end.size());
        head += content;
    }

    std::vector<uint8_t> pixels(width * height * channels);
    const size_t across = (width + wide - 1) / wide;
    for (size_t i = 0; i < places.size(); ++i) {
        std::string_view piece = reader.text(places[i], sizes[i]);
        if (!piece.starts_with(jpeg_begin)) reader.fail("a TIFF strip or tile is no JPEG");
        piece.remove_prefix(jpeg_begin.size());
        std::string whole = head;
        whole += piece;
        const ImageHeader part = read_jpeg_header(file, whole);
        const size_t x = i % across * wide, y = i / across * high;
        const size_t rows = std::min(high, height - y), columns = std::min(wide, width - x);
        if (part.width != wide || part.height < rows || part.height > high || part.bits_per_pixel != 8 * channels)
            reader.fail("a TIFF strip or tile is a JPEG of another size");
        const RawImage image = read_oiio_pixels(file, whole, part, "jpeg");
        const auto* values = std::get_if<std::vector<uint8_t>>(&image.values);
        if (!values || image.channels != int(channels)) reader.fail("a TIFF strip or tile is another JPEG");
        for (size_t row = 0; row < rows; ++row)
            std::copy_n(values->begin() + ptrdiff_t(row * wide * channels), columns * channels,
                        pixels.begin() + ptrdiff_t(((y + row) * width + x) * channels));
    }
    RawImage out;
    out.width = int(width);
    out.height = int(height);
    out.channels = int(channels);
    out.values = std::move(pixels);
    return out;
}

}  // namespace radiafit

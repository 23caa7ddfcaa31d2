#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cctype>

#include "base/error.h"
#include "image/codecs.h"
#include "image/exif.h"
#include "image/other_kinds.h"
#include "image/tiff_directory.h"

namespace radiafit {
namespace {

constexpr uint64_t largest_tile = 2048;  // pixels a side; libtiff takes memory for whole tiles

template <class... Values>
void expect(const TiffDirectory& directory, TiffTag tag, uint64_t otherwise, const char* what, Values... known) {
    const uint64_t value = directory.value(tag, otherwise);
    if (!((value == uint64_t(known)) || ...)) directory.refuse(fmt::format("{} {}", what, value));
}

constexpr uint64_t jpeg = 7, zstd = 50000, palette = 3, white_is_zero = 0;

/// Refuses what is not read by its name, where it has one.
void check_packing(const TiffDirectory& directory) {
    constexpr std::pair<uint64_t, const char*> names[] = {
        {2, "CCITT"},    {3, "CCITT"},    {4, "CCITT"},    {6, "old-style JPEG"}, {34712, "JPEG 2000"},
        {34887, "LERC"}, {34925, "LZMA"}, {50001, "WebP"}, {50002, "JPEG XL"}};
    const uint64_t packing = directory.value(compression, 1), kind = directory.value(photometric, 99);
    for (const auto& [number, name] : names)
        if (packing == number) directory.refuse(fmt::format("compression {} ({})", number, name));
    expect(directory, compression, 1, "compression", 1, 5, jpeg, 8, 32773, 32946, zstd);
    if (kind == 4) directory.refuse("photometric interpretation 4 (a mask)");
    if (kind == 5) directory.refuse("photometric interpretation 5 (CMYK colours, which are for printing)");
    if (kind == 8) directory.refuse("photometric interpretation 8 (CIE L*a*b*)");
    if (kind == 32803 || kind == 34892) directory.refuse("a camera's raw values");
    if (packing == jpeg)
        expect(directory, photometric, 99, "photometric interpretation", 1, 2, 6);
    else
        expect(directory, photometric, 99, "photometric interpretation", 0, 1, 2, palette);
}

/// The first picture of many cameras' raw files is a small preview.
void check_whole_picture(const std::filesystem::path& file, std::string_view bytes) {
    const bool dng = find_tiff_value(bytes, 50706).has_value();
    const auto kind = find_tiff_value(bytes, 254);  // NewSubfileType
    const bool reduced =
        kind && !kind->bytes.empty() && (kind->bytes[kind->big_endian ? kind->bytes.size() - 1 : 0] & 1);
    if (dng || is_raw_name(file) || (bytes.size() >= 12 && bytes.substr(8, 4) == std::string_view("CR\2\0", 4)))
        throw UserError(fmt::format("{}: a camera's raw picture, which is not read: {}", file.string(), raw_cure));
    if (reduced)
        throw UserError(fmt::format("{}: a TIFF whose first picture is a preview: export the picture itself, alone",
                                    file.string()));
}

/// Bits of one channel.
uint64_t check_kind(const TiffDirectory& directory) {
    check_packing(directory);
    expect(directory, fill_order, 1, "fill order", 1);
    expect(directory, planar_configuration, 1, "planar configuration", 1, 2);
    expect(directory, predictor, 1, "predictor", 1, 2, 3);
    expect(directory, samples_per_pixel, 1, "channels:", 1, 2, 3, 4);
    const uint64_t bits = directory.value(bits_per_sample, 1), format = directory.value(sample_format, 1);
    const bool whole = format == 1 && (bits == 8 || bits == 16), real = format == 3 && (bits == 16 || bits == 32);
    if (directory.value(photometric) == palette) {
        if (bits != 8 || format != 1 || directory.value(samples_per_pixel, 1) != 1)
            directory.refuse(fmt::format("a palette and {} bits", bits));
        if (directory.numbers(color_map).size() != 3 * 256) directory.reader().fail("a TIFF palette of another size");
    }
    if (directory.value(compression, 1) == jpeg) {
        if (bits != 8 || format != 1) directory.refuse(fmt::format("JPEG of {} bits", bits));
        const uint64_t channels = directory.value(samples_per_pixel, 1);
        if (channels != (directory.value(photometric) == 1 ? 1 : 3) || directory.value(planar_configuration, 1) != 1)
            directory.refuse("JPEG compression and channels apart or more than three");
    }
    if (real && directory.value(photometric) == white_is_zero)
        directory.refuse("photometric interpretation 0 (0 is white) of floats");
    if (!whole && !real) directory.refuse(fmt::format("channels of {} bits in sample format {}", bits, format));
    if (directory.numbers(bits_per_sample).size() != directory.value(samples_per_pixel, 1))
        directory.reader().fail("another number of TIFF channels than of their sizes");
    return bits;
}

/// OpenImageIO hands out garbage, and says nothing, where deflated bytes are damaged or fewer than `expected`. `most`:
/// of a whole strip or tile.
void check_deflated(const ByteReader& reader, std::string_view packed, uint64_t expected, uint64_t most) {
    z_stream stream = {};
    if (inflateInit(&stream) != Z_OK) throw SystemError("inflateInit failed");
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));  // zlib reads only
    stream.avail_in = static_cast<uInt>(packed.size());
    std::array<Bytef, 1 << 14> piece;
    int code = Z_OK;
    while (code == Z_OK && stream.total_out <= most) {
        stream.next_out = piece.data();
        stream.avail_out = static_cast<uInt>(piece.size());
        code = inflate(&stream, Z_NO_FLUSH);
    }
    const uint64_t unpacked = stream.total_out;
    inflateEnd(&stream);
    if (code != Z_STREAM_END || unpacked < expected) reader.fail("a TIFF strip or tile does not unpack");
}

/// Every strip or tile must lie within the file, and there must be as many as the picture needs.
void check_pieces(const TiffDirectory& directory, const ImageHeader& header) {
    const bool tiled = directory.has(tile_offsets);
    if (tiled == directory.has(strip_offsets)) directory.reader().fail("a TIFF of neither strips nor tiles");
    uint64_t wide = header.width, high = std::min(directory.value(rows_per_strip, header.height), header.height);
    if (tiled) {
        wide = directory.value(tile_width);
        high = directory.value(tile_length);
        if (wide > largest_tile || high > largest_tile) directory.refuse(fmt::format("tiles of {} x {}", wide, high));
    }
    if (wide < 1 || high < 1) directory.reader().fail("TIFF strips or tiles without pixels");
    const auto pieces = [](uint64_t side, uint64_t piece) { return (side + piece - 1) / piece; };
    const uint64_t planes = directory.value(planar_configuration, 1) == 2 ? directory.value(samples_per_pixel, 1) : 1;
    const uint64_t expected = pieces(header.width, wide) * pieces(header.height, high) * planes;
    const auto& offsets = directory.numbers(tiled ? tile_offsets : strip_offsets);
    const auto& sizes = directory.numbers(tiled ? tile_byte_counts : strip_byte_counts);
    if (offsets.size() != expected || sizes.size() != expected)
        directory.reader().fail("another number of TIFF strips or tiles than the picture needs");
    const bool deflated = directory.value(compression, 1) == 8 || directory.value(compression, 1) == 32946;
    const uint64_t across = pieces(header.width, wide), down = pieces(header.height, high);
    for (size_t i = 0; i < expected; ++i) {
        const uint64_t all = directory.reader().size();
        if (sizes[i] == 0 || sizes[i] > all || offsets[i] > all - sizes[i])
            directory.reader().fail("the file ends within a TIFF strip or tile");
        const uint64_t last = header.height - (down - 1) * high;  // rows of the last strip
        const uint64_t rows = !tiled && i / across % down == down - 1 ? last : high;
        if (deflated)
            check_deflated(directory.reader(), directory.reader().text(offsets[i], sizes[i]),
                           rows * wide * header.bits_per_pixel / planes / 8,
                           high * wide * header.bits_per_pixel / planes / 8);
    }
}

/// TIFF 6.0, section 20. Of a file that says nothing of its white, that is D65.
void take_chromaticities(std::string_view bytes, ColorTags& tags) {
    constexpr uint16_t white_point = 318, primary_chromaticities = 319;
    const std::vector<double> primaries = tiff_fractions(bytes, primary_chromaticities);
    const std::vector<double> white = tiff_fractions(bytes, white_point);
    if (primaries.size() != 6) return;
    tags.chromaticities = srgb_chromaticities;
    std::ranges::copy(primaries, tags.chromaticities.begin());
    if (white.size() == 2) std::ranges::copy(white, tags.chromaticities.begin() + 6);
    tags.numbers_by = "its chromaticities";
}

}  // namespace

ImageHeader read_tiff_header(const std::filesystem::path& file, std::string_view bytes) {
    check_whole_picture(file, bytes);
    const ByteReader reader = open_tiff(file, bytes);
    const TiffDirectory directory(reader);
    ImageHeader header{directory.value(image_width), directory.value(image_length), 0};
    if (header.width < 1 || header.height < 1 || header.width > largest_image_side ||
        header.height > largest_image_side)
        return header;  // the caller says so
    header.bits_per_pixel = check_kind(directory) * directory.value(samples_per_pixel, 1);
    check_pieces(directory, header);
    header.orientation = tiff_orientation(bytes);
    constexpr uint16_t profile = 34675;
    if (const auto value = find_tiff_value(bytes, profile)) take_profile(value->bytes, header.colors);
    take_chromaticities(bytes, header.colors);
    return header;
}

RawImage read_tiff_pixels(const std::filesystem::path& file, std::string bytes, const ImageHeader& header) {
    const ByteReader reader = open_tiff(file, bytes);
    const TiffDirectory directory(reader);
    if (directory.value(compression, 1) == jpeg) return read_tiff_jpegs(file, bytes, header);
    const bool inverted = directory.value(photometric, 1) == white_is_zero;
    const TiffLayout layout(reader);
    uint64_t kept = 0;
    for (uint64_t i = 0; i < layout.count; ++i) {
        const uint64_t from = layout.entry(i);
        if (!is_needed_tag(reader.number(from, 2))) continue;
        std::copy_n(bytes.begin() + ptrdiff_t(from), layout.entry_bytes,
                    bytes.begin() + ptrdiff_t(layout.entry(kept++)));
    }
    std::fill_n(bytes.begin() + ptrdiff_t(layout.entry(kept)), layout.word, '\0');  // no next directory
    std::fill_n(bytes.begin() + ptrdiff_t(layout.begin), layout.count_bytes, '\0');
    const uint64_t low = bytes.starts_with("II") ? 0 : layout.count_bytes - 1;
    bytes[layout.begin + low] = char(kept);  // fewer than 256 tags are needed
    RawImage image = read_oiio_pixels(file, bytes, header, "tiff");
    if (auto* wide = std::get_if<std::vector<uint16_t>>(&image.values); wide && inverted)
        for (size_t i = 0; i < wide->size(); ++i)  // which OpenImageIO does of 8 bits alone
            if (int(i % size_t(image.channels)) != image.alpha) (*wide)[i] = uint16_t(65535 - (*wide)[i]);
    return image;
}

}  // namespace radiafit

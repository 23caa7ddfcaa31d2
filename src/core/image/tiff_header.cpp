#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <vector>

#include "base/error.h"
#include "image/byte_reader.h"
#include "image/codecs.h"

namespace radiafit {
namespace {

constexpr uint64_t entry_bytes = 12;
constexpr uint64_t largest_tile = 2048;  // pixels a side; libtiff takes memory for whole tiles

/// Tags of the TIFF specification that the pixels need.
enum Tag : uint64_t {
    image_width = 256,
    image_length = 257,
    bits_per_sample = 258,
    compression = 259,
    photometric = 262,
    fill_order = 266,
    strip_offsets = 273,
    samples_per_pixel = 277,
    rows_per_strip = 278,
    strip_byte_counts = 279,
    planar_configuration = 284,
    predictor = 317,
    tile_width = 322,
    tile_length = 323,
    tile_offsets = 324,
    tile_byte_counts = 325,
    extra_samples = 338,
    sample_format = 339
};
constexpr Tag needed[] = {image_width,          image_length,  bits_per_sample,   compression,    photometric,
                          fill_order,           strip_offsets, samples_per_pixel, rows_per_strip, strip_byte_counts,
                          planar_configuration, predictor,     tile_width,        tile_length,    tile_offsets,
                          tile_byte_counts,     extra_samples, sample_format};

bool is_needed(uint64_t tag) { return std::find(std::begin(needed), std::end(needed), tag) != std::end(needed); }

ByteReader open_reader(const std::filesystem::path& file, std::string_view bytes) {
    return {file, bytes, bytes.starts_with("II") ? ByteReader::Order::little_endian : ByteReader::Order::big_endian};
}

/// The first directory: the numbers of every entry that the pixels need.
class Directory {
public:
    explicit Directory(const ByteReader& reader) : reader_(reader) {
        const uint64_t begin = reader.number(4, 4), count = reader.number(begin, 2);
        uint64_t last = 0;
        for (uint64_t i = 0; i < count; ++i) {
            const uint64_t at = begin + 2 + i * entry_bytes, tag = reader.number(at, 2);
            if (i > 0 && tag <= last) reader.fail("a TIFF directory out of order");
            if (is_needed(tag)) read_entry(tag, at);
            last = tag;
        }
        reader.number(begin + 2 + count * entry_bytes, 4);  // the next directory's place
    }

    bool has(Tag tag) const { return entries_.contains(tag); }
    const std::vector<uint64_t>& numbers(Tag tag) const {
        if (!has(tag)) reader_.fail("a TIFF directory without what the pixels need");
        return entries_.at(tag);
    }
    /// The entry's one number; of several, which must be equal, the first.
    uint64_t value(Tag tag, std::optional<uint64_t> otherwise = {}) const {
        if (!has(tag) && otherwise) return *otherwise;
        const std::vector<uint64_t>& all = numbers(tag);
        if (all.empty() || std::any_of(all.begin(), all.end(), [&](uint64_t n) { return n != all[0]; }))
            refuse("channels that differ");
        return all[0];
    }
    [[noreturn]] void refuse(const std::string& what) const {
        throw UserError(fmt::format("{}: a TIFF with {}: convert the image to PNG", reader_.file().string(), what));
    }
    const ByteReader& reader() const { return reader_; }

private:
    void read_entry(uint64_t tag, uint64_t at) {
        const uint64_t type = reader_.number(at + 2, 2), count = reader_.number(at + 4, 4);
        const int size = type == 1 ? 1 : type == 3 ? 2 : type == 4 ? 4 : 0;
        if (size == 0) reader_.fail("a TIFF entry that holds no whole numbers");
        const uint64_t place = count * uint64_t(size) <= 4 ? at + 8 : reader_.number(at + 8, 4);
        reader_.text(place, count * uint64_t(size));  // all there, before memory is taken for them
        std::vector<uint64_t>& list = entries_[tag];
        for (uint64_t i = 0; i < count; ++i) list.push_back(reader_.number(place + i * uint64_t(size), size));
    }

    const ByteReader& reader_;
    std::map<uint64_t, std::vector<uint64_t>> entries_;
};

template <class... Values>
void expect(const Directory& directory, Tag tag, uint64_t otherwise, const char* what, Values... known) {
    const uint64_t value = directory.value(tag, otherwise);
    if (!((value == uint64_t(known)) || ...)) directory.refuse(fmt::format("{} {}", what, value));
}

/// Bits of one channel.
uint64_t check_kind(const Directory& directory) {
    expect(directory, compression, 1, "compression", 1, 5, 8, 32773, 32946);
    expect(directory, photometric, 99, "photometric interpretation", 0, 1, 2);
    expect(directory, fill_order, 1, "fill order", 1);
    expect(directory, planar_configuration, 1, "planar configuration", 1, 2);
    expect(directory, predictor, 1, "predictor", 1, 2, 3);
    expect(directory, samples_per_pixel, 1, "channels:", 1, 2, 3, 4);
    const uint64_t bits = directory.value(bits_per_sample, 1), format = directory.value(sample_format, 1);
    const bool whole = format == 1 && (bits == 8 || bits == 16), real = format == 3 && (bits == 16 || bits == 32);
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
void check_pieces(const Directory& directory, const ImageHeader& header) {
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
        if (sizes[i] == 0 || offsets[i] + sizes[i] > directory.reader().size())
            directory.reader().fail("the file ends within a TIFF strip or tile");
        const uint64_t last = header.height - (down - 1) * high;  // rows of the last strip
        const uint64_t rows = !tiled && i / across % down == down - 1 ? last : high;
        if (deflated)
            check_deflated(directory.reader(), directory.reader().text(offsets[i], sizes[i]),
                           rows * wide * header.bits_per_pixel / planes / 8,
                           high * wide * header.bits_per_pixel / planes / 8);
    }
}

}  // namespace

ImageHeader read_tiff_header(const std::filesystem::path& file, std::string_view bytes) {
    const ByteReader reader = open_reader(file, bytes);
    const Directory directory(reader);
    ImageHeader header{directory.value(image_width), directory.value(image_length), 0};
    if (header.width < 1 || header.height < 1 || header.width > largest_image_side ||
        header.height > largest_image_side)
        return header;  // the caller says so
    header.bits_per_pixel = check_kind(directory) * directory.value(samples_per_pixel, 1);
    check_pieces(directory, header);
    return header;
}

RawImage read_tiff_pixels(const std::filesystem::path& file, std::string bytes, const ImageHeader& header) {
    const ByteReader reader = open_reader(file, bytes);
    const uint64_t begin = reader.number(4, 4), count = reader.number(begin, 2);
    uint64_t kept = 0;
    for (uint64_t i = 0; i < count; ++i) {
        const uint64_t from = begin + 2 + i * entry_bytes;
        if (!is_needed(reader.number(from, 2))) continue;
        std::copy_n(bytes.begin() + ptrdiff_t(from), entry_bytes,
                    bytes.begin() + ptrdiff_t(begin + 2 + entry_bytes * kept++));
    }
    const uint64_t end = begin + 2 + entry_bytes * kept;
    std::fill_n(bytes.begin() + ptrdiff_t(end), 4, '\0');  // no next directory
    bytes[begin] = bytes[begin + 1] = '\0';
    bytes[begin + (bytes.starts_with("II") ? 0 : 1)] = char(kept);  // fewer than 256 tags are needed
    return read_oiio_pixels(file, bytes, header, "tiff");
}

}  // namespace radiafit

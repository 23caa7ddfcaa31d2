#pragma once
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "image/byte_reader.h"
#include "image/raw_image.h"

/// A TIFF's or BigTIFF's first directory, walked before a library sees it. Source: TIFF 6.0; BigTIFF's design.
namespace radiafit {

/// Tags of the TIFF specification that the pixels need.
enum TiffTag : uint64_t {
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
    color_map = 320,
    extra_samples = 338,
    sample_format = 339
};
inline constexpr TiffTag needed_tags[] = {image_width,    image_length,      bits_per_sample,      compression,
                                          photometric,    fill_order,        strip_offsets,        samples_per_pixel,
                                          rows_per_strip, strip_byte_counts, planar_configuration, predictor,
                                          tile_width,     tile_length,       tile_offsets,         tile_byte_counts,
                                          color_map,      extra_samples,     sample_format};

inline bool is_needed_tag(uint64_t tag) {
    return std::find(std::begin(needed_tags), std::end(needed_tags), tag) != std::end(needed_tags);
}

inline ByteReader open_tiff(const std::filesystem::path& file, std::string_view bytes) {
    return {file, bytes, bytes.starts_with("II") ? ByteReader::Order::little_endian : ByteReader::Order::big_endian};
}

/// Where the first directory's parts lie: a BigTIFF has wider numbers.
struct TiffLayout {
    uint64_t word = 4;         ///< bytes of a place in the file
    uint64_t count_bytes = 2;  ///< of the number of entries
    uint64_t entry_bytes = 12;
    uint64_t begin = 0, count = 0;  ///< the directory's place, and its entries

    explicit TiffLayout(const ByteReader& reader) {
        if (reader.number(2, 2) == 43) {
            if (reader.number(4, 2) != 8) reader.fail("a BigTIFF whose places have other than 8 bytes");
            word = 8, count_bytes = 8, entry_bytes = 20;
        }
        begin = reader.number(word, int(word));
        count = reader.number(begin, int(count_bytes));
    }
    uint64_t entry(uint64_t i) const { return begin + count_bytes + i * entry_bytes; }
};

/// The first directory: the numbers of every entry that the pixels need.
class TiffDirectory {
public:
    explicit TiffDirectory(const ByteReader& reader) : reader_(reader), layout_(reader) {
        uint64_t last = 0;
        for (uint64_t i = 0; i < layout_.count; ++i) {
            const uint64_t at = layout_.entry(i), tag = reader.number(at, 2);
            if (i > 0 && tag <= last) reader.fail("a TIFF directory out of order");
            if (is_needed_tag(tag)) read_entry(tag, at);
            last = tag;
        }
        reader.number(layout_.entry(layout_.count), int(layout_.word));  // the next directory's place
    }

    bool has(TiffTag tag) const { return entries_.contains(tag); }
    const std::vector<uint64_t>& numbers(TiffTag tag) const {
        if (!has(tag)) reader_.fail("a TIFF directory without what the pixels need");
        return entries_.at(tag);
    }
    /// The entry's one number; of several, which must be equal, the first.
    uint64_t value(TiffTag tag, std::optional<uint64_t> otherwise = {}) const {
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
        const uint64_t type = reader_.number(at + 2, 2), word = layout_.word, value = at + 4 + word;
        const uint64_t count = reader_.number(at + 4, int(word));
        const int size = type == 1 ? 1 : type == 3 ? 2 : type == 4 ? 4 : type == 16 && word == 8 ? 8 : 0;
        if (size == 0) reader_.fail("a TIFF entry that holds no whole numbers");
        if (count > reader_.size()) reader_.fail("the file ends within its header");
        const uint64_t place = count * uint64_t(size) <= word ? value : reader_.number(value, int(word));
        reader_.text(place, count * uint64_t(size));  // all there, before memory is taken for them
        std::vector<uint64_t>& list = entries_[tag];
        for (uint64_t i = 0; i < count; ++i) list.push_back(reader_.number(place + i * uint64_t(size), size));
    }

    const ByteReader& reader_;
    TiffLayout layout_;
    std::map<uint64_t, std::vector<uint64_t>> entries_;
};

/// Of a file whose strips or tiles are JPEGs (compression 7), checked as read_jpeg_header() checks a JPEG: each becomes
/// a JPEG of its own with the tables that they share, and is read as such.
RawImage read_tiff_jpegs(const std::filesystem::path& file, std::string_view bytes, const ImageHeader& header);

}  // namespace radiafit

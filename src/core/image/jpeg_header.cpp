#include <fmt/format.h>

#include "base/error.h"
#include "image/byte_reader.h"
#include "image/codecs.h"
#include "image/exif.h"

namespace radiafit {
namespace {

/// Whether the marker is a start of frame: C0 to CF but for the three tables (DHT, JPG, DAC) that lie among them.
bool is_frame(uint64_t marker) {
    return marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc;
}

/// What segments before the frame say of colours and orientation.
struct JpegMetadata {
    std::vector<std::string_view> profile;  ///< the pieces of an ICC profile
    std::string_view exif;                  ///< EXIF's data, which are a TIFF

    void take(uint64_t marker, std::string_view content) {
        constexpr std::string_view icc("ICC_PROFILE\0", 12), exif_begin("Exif\0\0", 6);
        if (marker == 0xe2 && content.starts_with(icc)) profile.push_back(content.substr(icc.size()));
        if (marker == 0xe1 && exif.empty() && content.starts_with(exif_begin)) exif = content.substr(exif_begin.size());
    }
};

/// Offset of the frame header's length.
uint64_t find_frame(const ByteReader& reader, JpegMetadata& metadata) {
    for (uint64_t at = 2;;) {
        if (reader.number(at, 1) != 0xff) reader.fail("a JPEG segment does not begin where the one before ends");
        while (reader.number(at, 1) == 0xff) ++at;  // fill bytes
        const uint64_t marker = reader.number(at++, 1);
        if (is_frame(marker)) return at;
        if (marker == 0xda || marker == 0xd9) reader.fail("no JPEG frame before its data");
        const uint64_t length = reader.number(at, 2);
        if (length < 2) reader.fail("a JPEG segment is too short");
        if (marker == 0xe1 || marker == 0xe2) metadata.take(marker, reader.text(at + 2, length - 2));
        at += length;
    }
}

}  // namespace

ImageHeader read_jpeg_header(const std::filesystem::path& file, std::string_view bytes) {
    const ByteReader reader(file, bytes, ByteReader::Order::big_endian);
    JpegMetadata metadata;
    const uint64_t frame = find_frame(reader, metadata) + 2;
    const uint64_t depth = reader.number(frame, 1), channels = reader.number(frame + 5, 1);
    if (depth != 8)
        throw UserError(fmt::format("{}: a JPEG of {} bits: convert the image to PNG", file.string(), depth));
    if (channels == 4)
        throw UserError(
            fmt::format("{}: a JPEG of CMYK colours, which are for printing: convert it to RGB", file.string()));
    if (channels != 1 && channels != 3)
        throw UserError(fmt::format("{}: has {} colour channels, neither grey nor RGB: convert the image to RGB",
                                    file.string(), channels));
    ImageHeader header{reader.number(frame + 3, 2), reader.number(frame + 1, 2), 8 * channels};
    header.orientation = tiff_orientation(metadata.exif);
    join_profile(metadata.profile, header.colors);
    if (exif_says_adobe_rgb(metadata.exif)) {
        header.colors.numbers_by = "EXIF (Adobe RGB)";
        header.colors.gamma = 256.0 / 563;
        header.colors.chromaticities = adobe_rgb_chromaticities;
    }
    return header;
}

}  // namespace radiafit

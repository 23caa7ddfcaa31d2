#include <fmt/format.h>
#include <png.h>
#include <zlib.h>

#include <cmath>
#include <csetjmp>
#include <cstring>
#include <optional>

#include "base/error.h"
#include "image/byte_reader.h"
#include "image/codecs.h"
#include "image/exif.h"

namespace radiafit {
namespace {

/// Handed to libpng's callbacks. No member has a destructor: libpng leaves by longjmp where it fails.
struct Source {
    const char* at;
    size_t left;
    size_t last_row_left;  ///< bytes that libpng may take from where it begins the last row
    bool last_row;
    char error[128];
};

void read_bytes(png_structp png, png_bytep to, size_t count) {
    auto* source = static_cast<Source*>(png_get_io_ptr(png));
    if (count > source->left) png_error(png, "the file ends within the picture");
    if (source->last_row) {
        if (count > source->last_row_left) png_error(png, "more image data than the picture has room for");
        source->last_row_left -= count;
    }
    std::memcpy(to, source->at, count);
    source->at += count;
    source->left -= count;
}

[[noreturn]] void keep_error(png_structp png, png_const_charp message) {
    auto* source = static_cast<Source*>(png_get_error_ptr(png));
    std::strncpy(source->error, message, sizeof(source->error) - 1);
    png_longjmp(png, 1);
}

void ignore_warning(png_structp, png_const_charp) {}

/// libpng's two handles, and calls of it that may fail.
class PngReader {
public:
    explicit PngReader(std::string_view bytes)
        : source_{bytes.data(), bytes.size(), 0, false, {}},
          png_(png_create_read_struct(PNG_LIBPNG_VER_STRING, &source_, keep_error, ignore_warning)),
          info_(png_create_info_struct(png_)) {
        png_set_read_fn(png_, &source_, read_bytes);
    }
    ~PngReader() { png_destroy_read_struct(&png_, &info_, nullptr); }
    PngReader(const PngReader&) = delete;
    PngReader& operator=(const PngReader&) = delete;

    /// Runs `calls` of libpng, in which nothing with a destructor may live. False where one failed.
    template <class Calls>
    bool run(const Calls& calls) {
        if (setjmp(png_jmpbuf(png_))) return false;
        calls(png_, info_);
        return true;
    }
    const char* error() const { return source_.error; }
    /// libpng unpacks all image data that follows the last row's, of which a small file can hold gigabytes.
    void begin_last_row(size_t row_bytes) {
        constexpr size_t slack = 1 << 16;
        source_.last_row_left = 2 * row_bytes + slack;
        source_.last_row = true;
    }
    bool is_linear() const;

private:
    Source source_;
    png_structp png_;
    png_infop info_;
};

/// A gamma of 1 to two digits, and no sRGB chunk that says otherwise.
bool PngReader::is_linear() const {
    double gamma = 0;
    return !png_get_valid(png_, info_, PNG_INFO_sRGB) && png_get_gAMA(png_, info_, &gamma) && gamma > 0 &&
           std::round(100 / gamma) == 100;
}

/// Whole 8 or 16 bits per channel, in this machine's order; comments, profiles and the like are passed over unread.
/// Returns how often its rows are read: 7 times if it is interlaced.
int begin(png_structp png, png_infop info) {
    constexpr png_byte kept[] = "gAMA\0sRGB";
    png_set_user_limits(png, largest_image_side, largest_image_side);
    png_set_keep_unknown_chunks(png, PNG_HANDLE_CHUNK_NEVER, nullptr, -1);
    png_set_keep_unknown_chunks(png, PNG_HANDLE_CHUNK_AS_DEFAULT, kept, 2);
    png_read_info(png, info);
    png_set_expand(png);
    if (png_get_bit_depth(png, info) == 16) png_set_swap(png);
    const int passes = png_set_interlace_handling(png);
    png_read_update_info(png, info);
    return passes;
}

/// What a chunk says of colours and orientation. Source: PNG specification, 11.3.3 and 11.3.4.
void take_chunk(const ByteReader& reader, uint64_t at, uint64_t length, ImageHeader& header) {
    const std::string_view type = reader.text(at + 4, 4), content = reader.text(at + 8, length);
    ColorTags& colors = header.colors;
    if (type == "sRGB" && length == 1) colors.srgb = "the chunk sRGB";
    if (type == "gAMA" && length == 4) colors.gamma = double(reader.number(at + 8, 4)) / 100000;
    if (type == "iCCP" && !colors.has_profile()) unpack_profile(content, colors);
    if (type == "eXIf") header.orientation = tiff_orientation(content);
    if (type == "cHRM" && length == 32)
        for (uint64_t i = 0; i < 8; ++i)  // stored white, red, green, blue
            colors.chromaticities[(i + 6) % 8] = double(reader.number(at + 8 + 4 * i, 4)) / 100000;
}

}  // namespace

ImageHeader read_png_header(const std::filesystem::path& file, std::string_view bytes) {
    const ByteReader reader(file, bytes, ByteReader::Order::big_endian);
    if (reader.number(0, 8) != 0x89504e470d0a1a0a) reader.fail("PNG signature differs");
    ImageHeader header;
    std::optional<ColorNumbers> numbers;
    for (uint64_t at = 8;;) {
        if (at + 12 > reader.size()) reader.fail("the file ends within a PNG chunk");
        const uint64_t length = reader.number(at, 4);
        if (length > reader.size() - at - 12) reader.fail("the file ends within a PNG chunk");
        const std::string_view chunk = reader.text(at + 4, length + 4);
        if (crc32_z(0, reinterpret_cast<const Bytef*>(chunk.data()), chunk.size()) != reader.number(at + 8 + length, 4))
            reader.fail("PNG checksum differs");
        if (at == 8 && (length != 13 || !chunk.starts_with("IHDR"))) reader.fail("a PNG without header");
        if (chunk == "IEND") break;
        take_chunk(reader, at, length, header);
        if (chunk.starts_with("cICP") && length == 4) numbers = {int(uint8_t(chunk[4])), int(uint8_t(chunk[5]))};
        at += 12 + length;
    }
    if (numbers) {  // which go before everything else. Source: PNG specification, third edition, 4.3
        const std::string other = take_numbers(*numbers, "the chunk cICP", header.colors);
        if (!other.empty())
            throw UserError(fmt::format("{}: {}, which is not read: export it as sRGB", file.string(), other));
    }
    const uint64_t type = reader.number(25, 1);
    const uint64_t channels = type == 2 ? 3 : type == 4 ? 2 : type == 6 ? 4 : 1;
    header.width = reader.number(16, 4);
    header.height = reader.number(20, 4);
    header.bits_per_pixel = channels * reader.number(24, 1);
    return header;
}

RawImage read_png_pixels(const std::filesystem::path& file, std::string bytes, const ImageHeader&) {
    PngReader reader(bytes);
    RawImage image;
    png_uint_32 width = 0, height = 0;
    size_t row_bytes = 0;
    int passes = 1;
    bool deep = false;
    const bool begun = reader.run([&](png_structp png, png_infop info) {
        passes = begin(png, info);
        width = png_get_image_width(png, info);
        height = png_get_image_height(png, info);
        image.channels = png_get_channels(png, info);
        row_bytes = png_get_rowbytes(png, info);
        deep = png_get_bit_depth(png, info) == 16;
    });
    if (!begun) fail_damaged_image(file, reader.error());
    image.width = int(width);
    image.height = int(height);
    image.alpha = image.channels % 2 == 0 ? image.channels - 1 : -1;
    image.linear = reader.is_linear();

    std::vector<uint8_t> values8;
    std::vector<uint16_t> values16;
    png_bytep pixels = nullptr;
    if (deep) {
        values16.resize(row_bytes / 2 * height);
        pixels = reinterpret_cast<png_bytep>(values16.data());
    } else {
        values8.resize(row_bytes * height);
        pixels = values8.data();
    }
    const bool read = reader.run([&](png_structp png, png_infop) {
        for (int pass = 0; pass < passes; ++pass)
            for (size_t y = 0; y < height; ++y) {
                if (pass + 1 == passes && y + 1 == height) reader.begin_last_row(row_bytes);
                png_read_row(png, pixels + y * row_bytes, nullptr);
            }
    });
    if (!read) fail_damaged_image(file, reader.error());
    if (deep)
        image.values = std::move(values16);
    else
        image.values = std::move(values8);
    return image;
}

}  // namespace radiafit

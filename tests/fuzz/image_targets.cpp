// Photographs, masks and maps of normals of captures.
#include <OpenImageIO/imageio.h>
#include <zlib.h>

#include <optional>

#include "capture/normal_file.h"
#include "capture/picture_colors.h"
#include "capture_fixture.h"
#include "heif_bytes.h"
#include "image/image_file.h"
#include "picture_bytes.h"
#include "target.h"

namespace radiafit::fuzz {
using namespace tools;
namespace {

using Seeds = std::vector<std::string>;
constexpr int width = 7, height = 5;

/// Every way in which a capture reads a picture. Refused if all of them refuse.
void read_image_file(const fs::path& file) {
    std::optional<UserError> refusal;
    int taken = 0;
    for (const auto& way :
         std::vector<std::function<void()>>{[&] { read_image(file); },
                                            [&] {
                                                ImageFile image = read_image(file, true);
                                                convert_colors(image);
                                            },
                                            [&] { read_mask(file); }, [&] { read_normal_file(file); }}) {
        try {
            way();
            ++taken;
        } catch (const UserError& e) {
            refusal = e;
        }
    }
    if (!taken) throw *refusal;
}

/// As other programs write them: `name` decides on the format, `compression` is OpenImageIO's word.
std::string written(const fs::path& folder, const char* name, int channels, OIIO::TypeDesc type,
                    const char* compression, bool tiles = false) {
    OIIO::ImageSpec spec(width, height, channels, type);
    if (*compression) spec.attribute("compression", compression);
    if (tiles) spec.tile_width = spec.tile_height = 16;
    const fs::path file = folder / name;
    const auto output = OIIO::ImageOutput::create(file.string());
    std::vector<float> values;
    for (int i = 0; i < width * height * channels; ++i) values.push_back(float(i % 19) / 18);
    if (!output || !output->open(file.string(), spec) || !output->write_image(OIIO::TypeDesc::FLOAT, values.data()) ||
        !output->close())
        throw std::runtime_error("no seed: " + OIIO::geterror());
    return bytes_of(file);
}

Seeds png_seeds(const fs::path& folder) {
    Seeds seeds;
    for (const int bits : {8, 16})
        for (const int channels : {3, 1, 2, 4}) {
            std::vector<uint16_t> samples;
            for (int i = 0; i < width * height * channels; ++i) samples.push_back(uint16_t(i * 7 % (1 << bits)));
            seeds.push_back(testing::encode_png(width, height, channels, bits, samples));
        }
    seeds.push_back(written(folder, "other.png", 3, OIIO::TypeDesc::UINT8, ""));
    seeds.push_back(testing::plain_png(1, 1, 8, 2, testing::stored_zlib(std::string(4, '\1')),
                                       testing::iccp_chunk(testing::display_p3().encode()) +
                                           testing::png_chunk("eXIf", testing::encode_exif(6)) +
                                           testing::png_chunk("gAMA", testing::big_endian(55556))));
    return seeds;
}

Seeds jpeg_seeds(const fs::path& folder) {
    return {written(folder, "other.jpg", 3, OIIO::TypeDesc::UINT8, "jpeg:90"),
            written(folder, "other.jpg", 1, OIIO::TypeDesc::UINT8, "jpeg:50")};
}

Seeds tiff_seeds(const fs::path& folder) {
    Seeds seeds;
    for (const char* compression : {"none", "lzw", "zip", "packbits"})
        for (const auto type : {OIIO::TypeDesc::UINT8, OIIO::TypeDesc::UINT16, OIIO::TypeDesc::FLOAT})
            for (const int channels : {3, 1, 4})
                seeds.push_back(written(folder, "other.tif", channels, type, compression));
    seeds.push_back(written(folder, "other.tif", 3, OIIO::TypeDesc::UINT8, "none", true));
    seeds.push_back(written(folder, "other.tif", 3, OIIO::TypeDesc::UINT8, "jpeg:90"));
    seeds.push_back(written(folder, "other.tif", 3, OIIO::TypeDesc::UINT8, "zstd"));
    auto wide = testing::tiff_entries(2, 1, 3, 8);
    wide.erase(wide.begin() + 9);
    seeds.push_back(testing::encode_tiff(wide, "abcdef", false, true));
    return seeds;
}

Seeds exr_seeds(const fs::path& folder) {
    Seeds seeds;
    for (const char* compression : {"none", "rle", "zip", "zips", "piz", "pxr24", "b44", "dwaa"})
        for (const auto type : {OIIO::TypeDesc::HALF, OIIO::TypeDesc::FLOAT})
            seeds.push_back(written(folder, "other.exr", 3, type, compression));
    seeds.push_back(written(folder, "other.exr", 4, OIIO::TypeDesc::HALF, "zip"));
    seeds.push_back(written(folder, "other.exr", 1, OIIO::TypeDesc::FLOAT, "none", true));
    seeds.push_back(testing::encode_exr_channels({"A", "B", "G", "R", "Z"}, {1, 1, 2, 2}, {0, 0, 3, 3},
                                                 [](size_t c, int x, int y) { return float(c) + float(x + y); }));
    return seeds;
}

Seeds pfm_seeds(const fs::path&) {
    const std::string color = testing::encode_pfm(width, height, std::vector<float>(width * height * 3, 0.5f));
    std::string grey = testing::encode_pfm(width, height, std::vector<float>(width * height * 3, 0.5f));
    grey[1] = 'f';
    grey.resize(grey.size() - width * height * 8);
    return {color, grey};
}

Seeds heif_seeds(const fs::path&) {
    const auto value = [](int x, int y, int channel) { return (x + 2 * y + channel) % 19 / 18.0; };
    testing::HeifOptions plain, deep, other;
    plain.profile = testing::display_p3().encode();
    plain.orientation = heif_orientation_rotate_90_cw;
    deep.bits = 10;
    deep.primaries = 12;
    other.alpha = true;
    other.format = heif_compression_AV1;
    Seeds seeds;
    for (testing::HeifOptions* options : {&plain, &deep, &other}) {
        options->width = 16, options->height = 8;
        seeds.push_back(testing::encode_heif(*options, value));
    }
    return seeds;
}

uint32_t number_at(const std::string& bytes, size_t at) {
    uint32_t value = 0;
    for (size_t i = 0; i < 4; ++i) value = value << 8 | uint8_t(bytes[at + i]);
    return value;
}

/// Puts the checksums of a PNG's chunks right.
void vouch(const fs::path& file) {
    std::string png = bytes_of(file);
    for (size_t at = 8; at + 12 <= png.size();) {
        const uint64_t length = number_at(png, at);
        if (at + 12 + length > png.size()) break;
        const auto* chunk = reinterpret_cast<const Bytef*>(png.data() + at + 4);
        png.replace(at + 8 + length, 4, testing::big_endian(uint32_t(crc32_z(0, chunk, 4 + length))));
        at += 12 + length;
    }
    put_bytes(file, png);
}

/// A profile alone, of which a picture takes its colours. Refused where it is not used.
void read_profile(const fs::path& file) {
    ImageFile image;
    image.width = image.height = 2;
    image.rgb8.assign(12, 77);
    image.grey = true;
    image.colors.profile = bytes_of(file).substr(0, largest_profile);
    const ColorReading reading = convert_colors(image);
    if (!reading.ignored.empty() || image.colors.profile.empty()) throw UserError(reading.ignored);
}

Seeds profile_seeds(const fs::path&) {
    testing::IccProfile grey{.name = "Grey", .space = "GRAY"};
    // A table of two points a channel, in place of curves (type mft1).
    const std::string none(4, '\0');
    std::string table = "mft1" + none + std::string("\3\3\2\0", 4);
    for (int i = 0; i < 9; ++i) table += testing::big_endian(i % 4 ? 0 : 65536);
    for (int c = 0; c < 3; ++c)
        for (int i = 0; i < 256; ++i) table += char(i);
    for (int i = 0; i < 24; ++i) table += char(i % 3 == 0 ? i * 10 : 128);
    for (int c = 0; c < 3; ++c)
        for (int i = 0; i < 256; ++i) table += char(i);
    std::string lut = testing::display_p3().encode().substr(0, 128);
    lut.replace(20, 4, "Lab ");
    lut += testing::big_endian(1) + "A2B0" + testing::big_endian(144) + testing::big_endian(uint32_t(table.size())) +
           table;
    lut.replace(0, 4, testing::big_endian(uint32_t(lut.size())));
    return {testing::display_p3().encode(), testing::adobe_rgb().encode(), grey.encode(), lut};
}

Target target(const char* name, const char* file, Seeds (*seeds)(const fs::path&)) {
    return {name, file, seeds, [=](const fs::path& folder) { read_image_file(folder / file); }};
}

}  // namespace

std::vector<Target> image_targets() {
    const auto vouched = [](const fs::path& folder) {
        vouch(folder / "image.png");
        read_image_file(folder / "image.png");
    };
    return {{"png", "image.png", png_seeds, vouched},
            target("jpeg", "image.jpg", jpeg_seeds),
            target("tiff", "image.tif", tiff_seeds),
            target("image_exr", "image.exr", exr_seeds),
            target("heif", "image.heic", heif_seeds),
            target("pfm", "image.pfm", pfm_seeds),
            {"icc_profile", "profile.icc", profile_seeds,
             [](const fs::path& folder) { read_profile(folder / "profile.icc"); }}};
}

}  // namespace radiafit::fuzz

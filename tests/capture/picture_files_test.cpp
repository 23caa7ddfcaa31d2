// What pictures' files have beside plain pixels: orientation, windows, layers, packed strips, palettes.
#include <fmt/format.h>

#include "capture/photograph_file.h"
#include "image/exif.h"
#include "image/image_format.h"
#include "image/orientation.h"
#include "image/web/jpeg_image.h"
#include "picture_bytes.h"

namespace radiafit {
using namespace tools;
namespace {

using namespace testing;

std::string jpeg_segment(char marker, const std::string& content) {
    const size_t size = content.size() + 2;
    return std::string{'\xff', marker, char(size >> 8), char(size & 255)} + content;
}

class PictureFiles : public FolderTest {
protected:
    ImageFile read(const std::string& name, const std::string& bytes) {
        write_bytes(root_ / name, bytes);
        return read_image(root_ / name, true);
    }
    std::string refusal(const std::string& name, const std::string& bytes) {
        write_bytes(root_ / name, bytes);
        return complaint([&] { read_image(root_ / name, true); });
    }
};

TEST(Orientation, EveryOneOfTheEight) {
    // 3 x 2 as stored; upright, row by row, as EXIF's table has row 0 and column 0.
    const std::vector<int> stored = {1, 2, 3, 4, 5, 6};
    const std::vector<std::vector<int>> upright = {{1, 2, 3, 4, 5, 6}, {3, 2, 1, 6, 5, 4}, {6, 5, 4, 3, 2, 1},
                                                   {4, 5, 6, 1, 2, 3}, {1, 4, 2, 5, 3, 6}, {4, 1, 5, 2, 6, 3},
                                                   {6, 3, 5, 2, 4, 1}, {3, 6, 2, 5, 1, 4}};
    for (int o = 1; o <= 8; ++o) EXPECT_EQ(turn_upright(stored, o, 3, 2, 1), upright[size_t(o - 1)]) << o;
}

TEST_F(PictureFiles, OrientationsAndProfilesOfEveryFormat) {
    const std::string profile = display_p3().encode(), zlib = stored_zlib(std::string(4, '\0'));
    ImageFile image =
        read("x.png", plain_png(1, 1, 8, 2, zlib, png_chunk("eXIf", encode_exif(8)) + iccp_chunk(profile)));
    EXPECT_EQ(image.orientation, 8);
    EXPECT_EQ(image.colors.profile, profile);
    image = read("x.png", plain_png(1, 1, 8, 2, zlib, png_chunk("iCCP", "name")));
    expect_in("damaged", image.colors.damage);
    for (const bool wide : {false, true})
        for (const bool big : {false, true}) {
            auto entries = tiff_entries(1, 1, 3, 8);
            entries[9] = {274, 3, {6}};  // in place of extra channels; sorted below
            entries.push_back({34675, 7, std::vector<uint32_t>(profile.begin(), profile.end())});
            for (uint32_t& v : entries.back().values) v &= 255;
            for (TiffEntry& e : entries)
                if (e.tag == 273) e.values = {2048};
            std::ranges::sort(entries, {}, &TiffEntry::tag);
            image = read("x.tif", encode_tiff(entries, "\1\2\3", big, wide, 2048));
            EXPECT_EQ(image.rgb8, (std::vector<uint8_t>{1, 2, 3}));
            EXPECT_EQ(image.orientation, 6);
            EXPECT_EQ(image.colors.profile, profile);
        }
    // A JPEG's profile in two pieces, which may come in any order.
    const std::string icc("ICC_PROFILE\0", 12), whole = jpeg_bytes(8, 8, std::vector<uint8_t>(192, 99), 90);
    const std::string one = jpeg_segment('\xe2', icc + "\1\2" + profile.substr(0, 200));
    const std::string two = jpeg_segment('\xe2', icc + "\2\2" + profile.substr(200));
    const std::string exif = jpeg_segment('\xe1', std::string("Exif\0\0", 6) + encode_exif(3));
    image = read("x.jpg", whole.substr(0, 2) + exif + two + one + whole.substr(2));
    EXPECT_EQ(image.orientation, 3);
    EXPECT_EQ(image.colors.profile, profile);
    image = read("x.jpg", whole.substr(0, 2) + one + whole.substr(2));
    EXPECT_EQ(image.colors.profile, "");
    expect_in("not complete", image.colors.damage);
    // EXIF that is cut off anywhere says nothing.
    for (size_t size = 0; size < 19; ++size) EXPECT_EQ(tiff_orientation(encode_exif(6).substr(0, size)), 1);
    EXPECT_EQ(tiff_orientation(encode_exif(9)), 1);
}

/// Which pixel is which: red counts them.
std::string counted_png(int width, int height, const std::string& more) {
    std::string raw;
    for (int y = 0, i = 0; y < height; ++y) {
        raw += '\0';
        for (int x = 0; x < width; ++x) raw += std::string{char(i++), 0, 0};
    }
    return plain_png(uint32_t(width), uint32_t(height), 8, 2, stored_zlib(raw), more);
}

TEST_F(PictureFiles, PhotographsAreTurnedToTheCalibratedSizeAndMasksWithThem) {
    PhotographSource source;
    source.name = "a.png", source.image = root_ / "a.png";
    source.width = 2, source.height = 3, source.full_size = {2, 3};
    source.exif_orientation = "auto", source.expected_by = "cameras.txt calibrates", source.size_cure = "undistort";
    write_bytes(source.image, counted_png(3, 2, png_chunk("eXIf", encode_exif(6))));
    const auto reds = [&] {
        std::vector<int> reds;
        const PhotographFile file = read_photograph_file(source);
        for (size_t i = 0; i < file.image.rgb8.size(); i += 3) reds.push_back(file.image.rgb8[i]);
        return reds;
    };
    EXPECT_EQ(reds(), (std::vector<int>{3, 0, 4, 1, 5, 2}));
    EXPECT_TRUE(read_photograph_file(source).facts.turned);
    // A mask as stored is turned, an upright one is not.
    source.mask = root_ / "mask.png";
    write_bytes(source.mask, encode_png(3, 2, 1, 8, {255, 0, 0, 0, 0, 0}));
    EXPECT_EQ(read_photograph_file(source).mask.values, (std::vector<uint8_t>{0, 255, 0, 0, 0, 0}));
    write_bytes(source.mask, encode_png(2, 3, 1, 8, {255, 0, 0, 0, 0, 0}));
    EXPECT_EQ(read_photograph_file(source).mask.values, (std::vector<uint8_t>{255, 0, 0, 0, 0, 0}));
    source.mask.clear();
    source.exif_orientation = "stored";
    expect_in(
        "3 x 2 pixels, but cameras.txt calibrates 2 x 3, and its EXIF orientation 6 swaps the sides: give "
        "'exif_orientation' auto",
        complaint(reds));
    // Sides as calibrated: as stored, unless the user says otherwise.
    write_bytes(source.image, counted_png(2, 3, png_chunk("eXIf", encode_exif(3))));
    source.exif_orientation = "auto";
    EXPECT_EQ(reds(), (std::vector<int>{0, 1, 2, 3, 4, 5}));
    source.exif_orientation = "apply";
    EXPECT_EQ(reds(), (std::vector<int>{5, 4, 3, 2, 1, 0}));
    // Another size, whatever EXIF says.
    source.exif_orientation = "auto";
    write_bytes(source.image, counted_png(3, 2, ""));
    expect_in("3 x 2 pixels, but cameras.txt calibrates 2 x 3: undistort", complaint(reds));
    write_bytes(source.image, counted_png(3, 2, png_chunk("eXIf", encode_exif(3))));
    expect_in("does not explain it", complaint(reds));
}

TEST_F(PictureFiles, ExrChannelsAreTakenByName) {
    const ExrBox box = {0, 0, 1, 0};
    const auto numbered = [](size_t c, int x, int) { return float(10 * c) + float(x); };
    const auto exr = [&](const std::vector<std::string>& names) {
        return encode_exr_channels(names, box, box, numbered);
    };
    ImageFile image = read("x.exr", exr({"A", "B", "G", "R", "Z"}));
    EXPECT_EQ(image.rgb32, (std::vector<float>{30, 20, 10, 31, 21, 11}));
    EXPECT_EQ(image.alpha.size(), 2u);
    EXPECT_EQ(image.remarks, (std::vector<std::string>{"R, G, B, A taken, Z left out"}));
    EXPECT_EQ(read("x.exr", exr({"b", "g", "r"})).rgb32, (std::vector<float>{20, 10, 0, 21, 11, 1}));
    expect_in("neither R, G, B nor Y", refusal("x.exr", exr({"X", "Y", "Z"})));
    image = read("x.exr", exr({"B", "G", "N.X", "N.Y", "N.Z", "R", "a.B", "a.G", "a.R"}));
    EXPECT_EQ(image.rgb32, (std::vector<float>{50, 10, 0, 51, 11, 1}));
    image = read("x.exr", exr({"L.B", "L.G", "L.R", "L.Z"}));
    EXPECT_EQ(image.rgb32, (std::vector<float>{20, 10, 0, 21, 11, 1}));
    EXPECT_EQ(read("x.exr", exr({"B", "G", "R"})).remarks.size(), 0u);
    expect_in("2 layers of R, G, B (a. b.)", refusal("x.exr", exr({"a.B", "a.G", "a.R", "b.B", "b.G", "b.R"})));
    expect_in("the channels U, V, but neither", refusal("x.exr", exr({"U", "V"})));
}

TEST_F(PictureFiles, ExrWindowsAreFilledUpToTheDisplayWindow) {
    const auto place = [](const ExrBox& data) {
        return [=](size_t, int x, int y) { return float(10 * (y + data[1]) + x + data[0]); };
    };
    const auto exr = [&](const ExrBox& data, const ExrBox& display) {
        return read("x.exr", encode_exr_channels({"Y"}, data, display, place(data)));
    };
    ImageFile image = exr({1, 1, 2, 1}, {0, 0, 3, 2});  // 4 x 3, two pixels of it
    ASSERT_EQ(image.width, 4);
    ASSERT_EQ(image.height, 3);
    for (size_t i = 0; i < 12; ++i) {
        const bool there = i == 5 || i == 6;
        EXPECT_EQ(image.rgb32[3 * i], there ? float(10 + i - 4) : 0) << i;
        EXPECT_EQ(image.alpha[i], there ? 255 : 0) << i;
    }
    expect_in("left out outside the data window", image.remarks.at(0));
    image = exr({-1, -1, 4, 3}, {0, 0, 3, 2});  // overscan
    EXPECT_TRUE(image.alpha.empty());
    for (size_t i = 0; i < 12; ++i) EXPECT_EQ(image.rgb32[3 * i], float(10 * (i / 4) + i % 4));
    expect_in("cropped away", image.remarks.at(0));
    image = exr({2, 0, 5, 0}, {1, 0, 3, 0});  // beside it, and a display window that does not begin at 0
    EXPECT_EQ(image.width, 3);
    EXPECT_EQ(image.alpha, (std::vector<uint8_t>{0, 255, 255}));
    EXPECT_EQ(image.rgb32[3], 2);
    image = exr({9, 9, 9, 9}, {0, 0, 1, 1});  // nothing of it
    EXPECT_EQ(image.alpha, (std::vector<uint8_t>(4, 0)));
    expect_in("far larger",
              refusal("x.exr", encode_exr_channels({"Y"}, {0, 0, 0, 0}, {0, 0, 29999, 29999}, place({}))));
}

TEST_F(PictureFiles, TiffsPackedAsCamerasAndEditorsDo) {
    std::vector<uint8_t> rgb;
    for (int i = 0; i < 16 * 16 * 3; ++i) rgb.push_back(uint8_t(60 + i % 120));
    const std::string jpeg = jpeg_bytes(16, 16, rgb, 95);
    const ImageFile expected = read("x.jpg", jpeg);
    const auto entries = [&](uint32_t packing, uint32_t kind, uint32_t bytes) {
        auto list = tiff_entries(16, 16, 3, 8);
        list[3].values = {packing};
        list[4].values = {kind};
        list[8].values = {bytes};
        list.erase(list.begin() + 9);
        return list;
    };
    // One strip that is a whole JPEG; and its tables apart, as the format wants it.
    const auto packed = entries(7, 6, uint32_t(jpeg.size()));
    EXPECT_EQ(read("x.tif", encode_tiff(packed, jpeg)).rgb8, expected.rgb8);
    EXPECT_EQ(read("x.tif", encode_tiff(packed, jpeg, true, true)).rgb8, expected.rgb8);
    std::string tables = "\xff\xd8", rest = "\xff\xd8";
    for (size_t at = 2; at < jpeg.size();) {
        const size_t size = 2 + size_t(uint8_t(jpeg[at + 2])) * 256 + uint8_t(jpeg[at + 3]);
        const bool table = jpeg[at + 1] == '\xdb' || jpeg[at + 1] == '\xc4';
        if (jpeg[at + 1] == '\xda') {
            rest += jpeg.substr(at);
            break;
        }
        if (jpeg[at + 1] != '\xe0') (table ? tables : rest) += jpeg.substr(at, size);
        at += size;
    }
    tables += "\xff\xd9";
    auto apart = entries(7, 6, uint32_t(rest.size()));
    TiffEntry entry{347, 7, {}};
    for (const char c : tables) entry.values.push_back(uint8_t(c));
    apart.insert(std::ranges::find(apart, uint16_t(339), &TiffEntry::tag) + 1, entry);
    apart[5].values = {4096};
    const std::string whole = encode_tiff(apart, rest, false, false, 4096);
    EXPECT_EQ(read("x.tif", whole).rgb8, expected.rgb8);
    apart[4].values = {2};  // the channels are red, green and blue: nothing is to be converted
    EXPECT_NE(read("x.tif", encode_tiff(apart, rest, false, false, 4096)).rgb8, expected.rgb8);
    for (size_t size = 4096; size < whole.size(); size += 13) refusal("x.tif", whole.substr(0, size));
    // A palette of three colours.
    std::vector<uint32_t> map(768, 0);
    for (uint32_t i = 0; i < 3; ++i)
        map[i] = 257 * (10 + i), map[256 + i] = 257 * (20 + i), map[512 + i] = 257 * (30 + i);
    std::vector<TiffEntry> palette = tiff_entries(3, 1, 1, 8);
    palette.erase(palette.begin() + 9);
    palette[4].values = {3};
    palette[5].values = {4096};
    palette.insert(palette.begin() + 9, {320, 3, map});
    EXPECT_EQ(read("x.tif", encode_tiff(palette, std::string("\2\0\1", 3), false, false, 4096)).rgb8,
              (std::vector<uint8_t>{12, 22, 32, 10, 20, 30, 11, 21, 31}));
    // 16 bits of which 0 is white.
    auto white = tiff_entries(2, 1, 1, 16);
    for (TiffEntry& e : white)
        if (e.tag == 262) e.values = {0};
    EXPECT_EQ(read("x.tif", encode_tiff(white, std::string("\0\1\xff\xff", 4))).rgb16,
              (std::vector<uint16_t>{65279, 65279, 65279, 0, 0, 0}));
    palette[9].values.resize(700);
    expect_in("palette of another size", refusal("x.tif", encode_tiff(palette, "\2\1\1", false, false, 4096)));

    expect_in("compression 6 (old-style JPEG)", refusal("x.tif", encode_tiff(entries(6, 6, 768), jpeg)));
    expect_in("compression 34925 (LZMA)", refusal("x.tif", encode_tiff(entries(34925, 2, 768), jpeg)));
    expect_in("CMYK", refusal("x.tif", encode_tiff(entries(1, 5, 768), std::string(768, '\0'))));
    expect_in("camera's raw picture", refusal("x.dng", encode_tiff(entries(1, 2, 768), std::string(768, '\0'))));
    auto preview = entries(1, 2, 768);
    preview.insert(preview.begin(), {254, 4, {1}});
    expect_in("preview", refusal("x.tif", encode_tiff(preview, std::string(768, '\0'))));
}

TEST_F(PictureFiles, OtherKindsAreNamedWithWhatConvertsThem) {
    const std::vector<std::array<std::string, 3>> kinds = {
        {"RIFF1234WEBPVP8 ", "a WebP picture", "dwebp"},
        {"#?RADIANCE\n", "a Radiance picture", "oiiotool"},
        {"GIF89a", "a GIF picture", "convert"},
        {"BM123456", "a BMP picture", "convert"},
        {"FUJIFILMCCD-RAW 0201", "raw picture (RAF)", "darktable-cli"}};
    for (const auto& [bytes, kind, cure] : kinds) {
        const std::string text = refusal("x.jpg", bytes);
        expect_in(kind, text);
        expect_in(cure, text);
    }
    const std::string cmyk =
        std::string("\xff\xd8\xff\xc0\0\x14\x08\0\x08\0\x08\4", 12) + std::string(12, '\1') + std::string(40, '\0');
    expect_in("a JPEG of CMYK colours", refusal("x.jpg", cmyk));
}

}  // namespace
}  // namespace radiafit

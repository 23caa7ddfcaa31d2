// Colours by what files say: profiles, chunks, chromaticities; values by matrices of other sources.
#include "capture/picture_colors.h"

#include <cmath>

#include "capture/picture_facts.h"
#include "capture_fixture.h"
#include "dataset/dataset.h"
#include "image/exif.h"
#include "image/web/jpeg_image.h"
#include "picture_bytes.h"

namespace radiafit {
using namespace tools;
namespace {

double decoded(double stored) { return srgb_decode(stored); }

using namespace testing;
using Kind = ColorReading::Kind;
using Matrix = std::array<double, 9>;

// Linear light of Display P3 and of Adobe RGB (1998) in sRGB's primaries, rows; from their published chromaticities.
constexpr Matrix p3_to_srgb = {1.2249401, -0.2249404, 0, -0.0420569, 1.0420571, 0, -0.0196376, -0.0786361, 1.0982735};
constexpr Matrix adobe_to_srgb = {1.3983832, -0.3983831, 0, 0, 1, 0, 0, -0.0429383, 1.0429383};

/// 8 or 16 bits; colours that sRGB has, too.
ImageFile picture(int bits, const ColorTags& tags) {
    ImageFile image;
    image.width = 4;
    image.height = 1;
    image.bits = bits;
    image.colors = tags;
    image.format = "PNG";
    for (const int v : {128, 128, 128, 150, 120, 100, 90, 130, 120, 0, 255, 255}) {
        if (bits == 8) image.rgb8.push_back(uint8_t(v));
        if (bits == 16) image.rgb16.push_back(uint16_t(257 * v));
        if (bits == 32) image.rgb32.push_back(float(v) / 64);
    }
    return image;
}

ColorTags tags_of(const IccProfile& profile) {
    ColorTags tags;
    tags.profile = profile.encode();
    return tags;
}

/// A value of 0 to 1 that is clipped after the matrix.
double converted(const ImageFile& before, size_t i, const Matrix& m, const std::function<double(double)>& light) {
    const size_t pixel = i / 3 * 3, row = i % 3;
    double sum = 0;
    for (size_t c = 0; c < 3; ++c)
        sum += m[3 * row + c] *
               light(before.bits == 8 ? before.rgb8[pixel + c] / 255.0 : before.rgb16[pixel + c] / 65535.0);
    return std::clamp(sum, 0.0, 1.0);
}

TEST(PictureColors, ProfilesAreConvertedToTheRightValues) {
    const auto power = [](double v) { return std::pow(v, 2.19921875); };
    for (const bool p3 : {true, false})
        for (const int bits : {8, 16}) {
            SCOPED_TRACE(::testing::Message() << "P3 " << p3 << ", " << bits << " bits");
            const ImageFile before = picture(bits, tags_of(p3 ? display_p3() : adobe_rgb()));
            ImageFile image = before;
            const ColorReading reading = convert_colors(image);
            EXPECT_EQ(reading.kind, Kind::converted);
            EXPECT_EQ(reading.ignored, "");
            expect_in(p3 ? "'Display P3'" : "'Adobe RGB (1998)'", reading.by);
            EXPECT_EQ(image.linear, bits == 16);
            for (size_t i = 0; i < 12; ++i) {
                const double light =
                    p3 ? converted(before, i, p3_to_srgb, decoded) : converted(before, i, adobe_to_srgb, power);
                // One step of 8 bits; in light, what five digits of the primaries leave.
                if (bits == 8) {
                    EXPECT_NEAR(image.rgb8[i], 255 * srgb_encode(light), 1.0) << i;
                } else {
                    EXPECT_NEAR(image.rgb16[i] / 65535.0, light, 5e-4) << i;
                }
            }
        }
}

TEST(PictureColors, SrgbAndLinearLightKeepEveryBit) {
    IccProfile linear{.name = "linear"}, named{.name = "sRGB built-in"};
    linear.power = 1;
    named.power = 2.2;  // the curve that small profiles have in place of sRGB's
    ColorTags chunk, usual, one;
    chunk.srgb = "the chunk sRGB";
    usual.gamma = 0.45455;
    usual.chromaticities = {0.64, 0.33, 0.3, 0.6, 0.15, 0.06, 0.3127, 0.329};
    one.gamma = 1;
    const std::vector<std::pair<ColorTags, Kind>> all = {{tags_of({.name = "sRGB IEC61966-2.1"}), Kind::srgb},
                                                         {tags_of({.name = "c2"}), Kind::srgb},
                                                         {tags_of(named), Kind::srgb},
                                                         {tags_of(linear), Kind::linear},
                                                         {chunk, Kind::srgb},
                                                         {usual, Kind::srgb},
                                                         {one, Kind::linear},
                                                         {{}, Kind::unknown}};
    for (const auto& [tags, kind] : all)
        for (const int bits : {8, 16}) {
            const ImageFile before = picture(bits, tags);
            ImageFile image = before;
            const ColorReading reading = convert_colors(image);
            EXPECT_EQ(reading.kind, kind) << reading.by;
            EXPECT_EQ(image.rgb8, before.rgb8);
            EXPECT_EQ(image.rgb16, before.rgb16);
            EXPECT_EQ(image.linear, kind == Kind::linear);
        }
}

TEST(PictureColors, ChunksAndChromaticitiesAreConvertedAsProfilesAre) {
    ColorTags chunks;  // Adobe RGB (1998)
    chunks.gamma = 1 / 2.19921875;
    chunks.chromaticities = {0.64, 0.33, 0.21, 0.71, 0.15, 0.06, 0.3127, 0.329};
    const ImageFile before = picture(16, chunks);
    ImageFile image = before;
    EXPECT_EQ(convert_colors(image).kind, Kind::converted);
    for (size_t i = 0; i < 12; ++i)  // a gamma near 1 / 2.2 is sRGB's curve
        EXPECT_NEAR(image.rgb16[i] / 65535.0, converted(before, i, adobe_to_srgb, decoded), 5e-4) << i;
    chunks.gamma = 1 / 1.8;
    chunks.chromaticities = {};
    image = picture(16, chunks);
    EXPECT_EQ(convert_colors(image).kind, Kind::converted);
    EXPECT_NEAR(image.rgb16[0] / 65535.0, std::pow(128 / 255.0, 1.8), 1e-4);
    // Floats: primaries alone; nothing is clipped.
    ColorTags p3;
    p3.chromaticities = {0.68, 0.32, 0.265, 0.69, 0.15, 0.06, 0.3127, 0.329};
    image = picture(32, p3);
    EXPECT_EQ(convert_colors(image).kind, Kind::converted);
    EXPECT_NEAR(image.rgb32[0], 2, 1e-3);
    EXPECT_NEAR(image.rgb32[9], -0.2249404 * 255 / 64, 2e-3);
    p3.chromaticities[7] = 0;
    image = picture(32, p3);
    expect_in("its chromaticities are not used", convert_colors(image).ignored);
    EXPECT_EQ(image.rgb32, picture(32, p3).rgb32);
    // What cannot be used of a file leaves the rest in force.
    p3.gamma = 1;
    image = picture(16, p3);
    const ColorReading linear = convert_colors(image);
    expect_in("its chromaticities are not used", linear.ignored);
    EXPECT_EQ(linear.kind, Kind::linear);
    EXPECT_EQ(linear.by, "gAMA (1)");
    EXPECT_TRUE(image.linear);
    EXPECT_EQ(image.rgb16, picture(16, p3).rgb16);
}

/// EXIF as cameras write it that are set to Adobe RGB: three directories of one entry each, little-endian.
std::string exif_of_adobe_rgb() {
    const auto number = [](uint32_t value, size_t bytes) {
        std::string text;
        for (size_t i = 0; i < bytes; ++i) text += char(value >> (8 * i));
        return text;
    };
    const auto directory = [&](uint32_t tag, uint32_t type, uint32_t count, const std::string& value) {
        return number(1, 2) + number(tag, 2) + number(type, 2) + number(count, 4) + value + number(0, 4);
    };
    return "II" + number(42, 2) + number(8, 4) + directory(34665, 4, 1, number(26, 4)) +
           directory(40965, 4, 1, number(44, 4)) + directory(1, 2, 4, std::string("R03\0", 4));
}

class PictureColorsOfFiles : public FolderTest {};

TEST_F(PictureColorsOfFiles, ExifSaysAdobeRgb) {
    const std::string exif = exif_of_adobe_rgb();
    EXPECT_TRUE(exif_says_adobe_rgb(exif));
    for (size_t bytes = 0; bytes + 4 < exif.size(); ++bytes) EXPECT_FALSE(exif_says_adobe_rgb(exif.substr(0, bytes)));
    std::string other = exif;
    other[other.find("R03") + 2] = '8';
    EXPECT_FALSE(exif_says_adobe_rgb(other));

    const std::string jpeg = jpeg_bytes(8, 8, std::vector<uint8_t>(192, 99), 90);
    const std::string content = std::string("Exif\0\0", 6) + exif;
    const std::string segment =
        std::string{'\xff', '\xe1', char((content.size() + 2) >> 8), char((content.size() + 2) & 255)} + content;
    write_bytes(root_ / "x.jpg", jpeg.substr(0, 2) + segment + jpeg.substr(2));
    ImageFile image = read_image(root_ / "x.jpg");
    const ColorReading reading = convert_colors(image);
    EXPECT_EQ(reading.kind, Kind::converted);
    EXPECT_EQ(reading.by, "EXIF (Adobe RGB)");
}

TEST_F(PictureColorsOfFiles, PngsByNumbers) {
    const std::string grey = stored_zlib(std::string("\0\x50\x90\xa0", 4));
    const auto read = [&](char primaries, char curve, const std::string& more = "") {
        write_bytes(root_ / "x.png",
                    plain_png(1, 1, 8, 2, grey, png_chunk("cICP", std::string{primaries, curve, 0, 1}) + more));
        return read_image(root_ / "x.png");
    };
    ImageFile p3 = read(12, 13, png_chunk("sRGB", std::string(1, '\0')));  // goes before the chunk sRGB
    const ImageFile before = p3;
    EXPECT_EQ(convert_colors(p3).kind, Kind::converted);
    for (size_t c = 0; c < 3; ++c)
        EXPECT_NEAR(p3.rgb8[c], 255 * srgb_encode(converted(before, c, p3_to_srgb, decoded)), 1) << c;
    ImageFile srgb = read(1, 13, iccp_chunk(display_p3().encode()));
    EXPECT_EQ(convert_colors(srgb).by, "the chunk cICP");
    EXPECT_EQ(srgb.rgb8, before.rgb8);
    ImageFile linear = read(1, 8);
    EXPECT_EQ(convert_colors(linear).kind, Kind::linear);
    for (const char curve : {16, 18})
        expect_in("x.png: a picture of high dynamic range (PQ or HLG), which is not read: export it as sRGB",
                  complaint([&] { read(9, curve); }));
}

TEST_F(PictureColorsOfFiles, TiffsByChromaticities) {
    auto entries = tiff_entries(1, 1, 3, 8);
    entries.erase(entries.end() - 2);  // of alpha
    entries.insert(entries.end() - 1, {319, 5, {64, 100, 33, 100, 21, 100, 71, 100, 15, 100, 6, 100}});
    entries.insert(entries.end() - 2, {318, 5, {3127, 10000, 329, 1000}});
    write_bytes(root_ / "x.tif", encode_tiff(entries, "\x50\x90\xa0"));
    ImageFile image = read_image(root_ / "x.tif");
    const ImageFile before = image;
    const ColorReading reading = convert_colors(image);
    EXPECT_EQ(reading.by, "its chromaticities") << reading.ignored;
    EXPECT_EQ(reading.kind, Kind::converted);
    for (size_t c = 0; c < 3; ++c)
        EXPECT_NEAR(image.rgb8[c], 255 * srgb_encode(converted(before, c, adobe_to_srgb, decoded)), 1) << c;
}

TEST(PictureColors, GreyProfiles) {
    IccProfile grey{.name = "Dot Gain", .space = "GRAY"};
    grey.power = 1.8;
    ImageFile image = picture(8, tags_of(grey));
    expect_in("it is of grey, and the picture of colours", convert_colors(image).ignored);
    image.grey = true;
    EXPECT_EQ(convert_colors(image).kind, Kind::converted);
    EXPECT_NEAR(image.rgb8[0], 255 * srgb_encode(std::pow(128 / 255.0, 1.8)), 1);
}

TEST(PictureColors, ProfilesThatCannotBeUsedAreNamedAndChangeNothing) {
    const std::string good = display_p3().encode();
    std::string huge_curve = good;
    huge_curve.replace(huge_curve.find("para"), 12, std::string("curv\0\0\0\0\x7f\xff\xff\xff", 12));
    const std::vector<std::pair<std::string, const char*>> bad = {
        {good.substr(0, 300), "it is cut off"},
        {std::string(200, 'x'), "it is damaged"},
        {"", ""},
        {huge_curve, "it is damaged"},
        {IccProfile{.name = "Press", .space = "CMYK"}.encode(), "'Press' is not used: it is of CMYK"},
        {IccProfile{.name = "Lab", .space = "Lab "}.encode(), "it is not of RGB or grey"}};
    for (const auto& [bytes, words] : bad) {
        ColorTags tags;
        tags.profile = bytes;
        ImageFile image = picture(8, tags);
        const ColorReading reading = convert_colors(image);
        EXPECT_EQ(reading.kind, Kind::unknown);
        expect_in(words, reading.ignored);
        EXPECT_EQ(image.rgb8, picture(8, tags).rgb8);
    }
    // Damage at any byte is refused, or read as another profile, and the picture stays whole.
    for (size_t at = 0; at < good.size(); ++at) {
        ColorTags tags;
        tags.profile = good;
        tags.profile[at] = char(tags.profile[at] ^ 0x5a);
        ImageFile image = picture(8, tags);
        convert_colors(image);
        EXPECT_EQ(image.rgb8.size(), 12u);
    }
}

TEST(PictureFactsTest, AlikeIsSaidOnceAndOthersAreCounted) {
    std::vector<PictureFacts> facts;
    for (const char* name : {"0.jpg", "1.jpg", "2.jpg", "3.jpg", "4.jpg", "5.jpg"})
        facts.push_back({name, "8-bit JPEG: sRGB", "", {}});
    EXPECT_EQ(describe_pictures(facts, "").remarks, (std::vector<std::string>{"8-bit JPEG: sRGB"}));
    EXPECT_TRUE(describe_pictures(facts, "").notes.empty());
    facts[2].colors = facts[3].colors = "8-bit JPEG: converted";
    expect_in("2 of 6 pictures, such as 2.jpg: 8-bit JPEG: converted", describe_pictures(facts, "").remarks.at(1));
    for (PictureFacts& f : facts) f.orientation = 6;  // all alike: nothing to say
    EXPECT_TRUE(describe_pictures(facts, "").notes.empty());
    facts[0].orientation = 1;
    expect_in(
        "5 of 6 pictures carry an EXIF orientation (6) that is not applied: 1.jpg, 2.jpg, 3.jpg, 4.jpg, ...; cure",
        describe_pictures(facts, "cure").notes.at(0));
}

}  // namespace
}  // namespace radiafit

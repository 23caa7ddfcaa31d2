// Picture files: values of every format as they are stored, and what is refused before memory is taken.
#include "image/image_file.h"

#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <bit>
#include <cmath>
#include <map>
#include <random>
#include <set>

#include "capture_fixture.h"
#include "image/image_format.h"
#include "picture_bytes.h"

namespace radiafit {
namespace {

using namespace testing;
using Images = testing::FolderTest;

TEST_F(Images, PngValuesAreExact) {
    const int w = 5, h = 3;
    for (const int bits : {8, 16})
        for (const int channels : {1, 2, 3, 4}) {
            SCOPED_TRACE(std::to_string(bits) + " bits, " + std::to_string(channels) + " channels");
            const auto samples = ramp(size_t(w * h * channels), bits == 8 ? 255 : 65535);
            write_bytes(root_ / "x.png", encode_png(w, h, channels, bits, samples));
            const ImageFile image = read_image(root_ / "x.png");
            ASSERT_EQ(image.width, w);
            ASSERT_EQ(image.height, h);
            ASSERT_EQ(image.bits, bits);
            ASSERT_EQ(image.alpha.size(), channels % 2 == 0 ? size_t(w * h) : 0u);
            for (size_t i = 0; i < size_t(w * h); ++i) {
                for (size_t c = 0; c < 3; ++c) {
                    const uint16_t expected = samples[i * size_t(channels) + (channels >= 3 ? c : 0)];
                    EXPECT_EQ(bits == 8 ? image.rgb8[3 * i + c] : image.rgb16[3 * i + c], expected);
                }
                if (channels % 2 == 0) {
                    const double alpha = samples[(i + 1) * size_t(channels) - 1];
                    EXPECT_EQ(image.alpha[i], std::lround(bits == 8 ? alpha : alpha / 257));
                }
            }
        }
}

TEST_F(Images, DamagedPngIsAnErrorAtEveryByte) {
    const std::string whole = encode_png(6, 5, 3, 8, ramp(90, 255));
    const fs::path file = root_ / "x.png";
    write_bytes(file, whole);
    EXPECT_NO_THROW(read_image(file));
    for (size_t size = 0; size < whole.size(); ++size) {
        write_bytes(file, whole.substr(0, size));
        expect_in("x.png", complaint([&] { read_image(file); }));
    }
    for (size_t at = 0; at < whole.size(); ++at) {
        std::string damaged = whole;
        damaged[at] = static_cast<char>(damaged[at] ^ 0x10);
        write_bytes(file, damaged);
        expect_in("corrupt", complaint([&] { read_image(file); }));
    }
    expect_in("no such image", complaint([&] { read_image(root_ / "none.png"); }));
    write_bytes(file, "not an image at all, but long enough to be looked at");
    expect_in("corrupt", complaint([&] { read_image(file); }));
}

// 16 x 16 grey, baseline.
const char* const small_jpeg =
    "ffd8ffe000104a46494600010100000100010000ffdb0043000302020302020303030304030304050805050404050a070706080c0a0c0c0b0a"
    "0b0b0d0e12100d0e110e0b0b1016101113141515150c0f171816141812141514ffc0000b080010001001011100ffc4001f0000010501010101"
    "010100000000000000000102030405060708090a0bffc400b5100002010303020403050504040000017d010203000411051221314106135161"
    "07227114328191a1082342b1c11552d1f02433627282090a161718191a25262728292a3435363738393a434445464748494a53545556575859"
    "5a636465666768696a737475767778797a838485868788898a92939495969798999aa2a3a4a5a6a7a8a9aab2b3b4b5b6b7b8b9bac2c3c4c5c6"
    "c7c8c9cad2d3d4d5d6d7d8d9dae1e2e3e4e5e6e7e8e9eaf1f2f3f4f5f6f7f8f9faffda0008010100003f00f04f0d7c36fb9fbafd2bd5bc35f0"
    "dbee7eebf4af55f0d7c36fb9fbafd2bd57c35f0dbee7eebf4affd9";

TEST_F(Images, TruncatedJpegIsAnErrorAtEveryByte) {
    std::string whole;
    for (const char* hex = small_jpeg; *hex; hex += 2)
        whole += static_cast<char>(std::stoi(std::string(hex, 2), nullptr, 16));
    const fs::path file = root_ / "x.jpg";
    write_bytes(file, whole);
    const ImageFile image = read_image(file);
    EXPECT_EQ(image.width, 16);
    EXPECT_EQ(image.rgb8.size(), size_t(16 * 16 * 3));
    // The picture rises from top left to bottom right.
    EXPECT_LT(image.rgb8.front() + 50, image.rgb8.back());
    for (size_t size = 0; size < whole.size(); ++size) {
        write_bytes(file, whole.substr(0, size));
        expect_in("x.jpg", complaint([&] { read_image(file); }));
    }
}

TEST_F(Images, MasksOfAllKinds) {
    using Values = std::vector<uint8_t>;
    const fs::path file = root_ / "m.png";
    const auto mask = [&](int channels, int bits, const std::vector<uint16_t>& samples) {
        write_bytes(file, encode_png(2, 2, channels, bits, samples));
        return read_mask(file).values;
    };
    EXPECT_EQ(mask(1, 8, {0, 127, 128, 255}), (Values{0, 0, 255, 255}));
    EXPECT_EQ(mask(1, 8, {0, 1, 1, 0}), (Values{0, 255, 255, 0}));  // files of 0 and 1
    EXPECT_EQ(mask(1, 8, {0, 0, 0, 0}), (Values{0, 0, 0, 0}));
    EXPECT_EQ(mask(1, 16, {0, 65535, 20000, 40000}), (Values{0, 255, 0, 255}));
    EXPECT_EQ(mask(1, 16, {0, 1, 38, 0}), (Values{0, 255, 255, 0}));  // labels
    EXPECT_EQ(mask(1, 16, {0, 255, 100, 255}), (Values{0, 255, 0, 255}));
    EXPECT_EQ(mask(3, 8, {0, 0, 0, 255, 255, 255, 0, 200, 0, 9, 9, 9}), (Values{0, 255, 255, 0}));
    EXPECT_EQ(mask(2, 8, {255, 255, 255, 0, 0, 255, 0, 0}), (Values{255, 0, 0, 0}));  // cut out by alpha
}

TEST_F(Images, PngPalettesBitsAndGamma) {
    const fs::path file = root_ / "x.png";
    // A palette of two colours, the second half transparent.
    const std::string palette = png_chunk("PLTE", "\1\2\3\4\5\6") + png_chunk("tRNS", "\xff\x80");
    write_bytes(file, plain_png(2, 1, 8, 3, stored_zlib({0, 1, 0}), palette));
    ImageFile image = read_image(file);
    EXPECT_EQ(image.rgb8, (std::vector<uint8_t>{4, 5, 6, 1, 2, 3}));
    EXPECT_EQ(image.alpha, (std::vector<uint8_t>{128, 255}));
    // One bit per pixel.
    write_bytes(file, plain_png(4, 1, 1, 0, stored_zlib({0, '\x50'})));
    EXPECT_EQ(read_mask(file).values, (std::vector<uint8_t>{0, 255, 0, 255}));
    // 16 bits are linear where the file's gamma is 1 and nothing says sRGB.
    const std::string gamma = png_chunk("gAMA", big_endian(100000)), srgb = png_chunk("sRGB", std::string(1, '\0'));
    const std::map<std::string, bool> linear = {
        {"", false}, {gamma, true}, {gamma + srgb, false}, {png_chunk("gAMA", big_endian(45455)), false}};
    for (const auto& [chunks, expected] : linear) {
        write_bytes(file, plain_png(1, 1, 16, 0, stored_zlib({0, 1, 2}), chunks));
        image = read_image(file);
        EXPECT_EQ(image.linear, expected);
        EXPECT_EQ(image.rgb16, (std::vector<uint16_t>{258, 258, 258}));
    }
}

// ---- TIFF ----

TEST_F(Images, TiffValuesAreExact) {
    const fs::path file = root_ / "x.tif";
    const uint32_t w = 5, h = 3;
    for (const uint32_t bits : {8u, 16u, 32u})
        for (const uint32_t channels : {1u, 2u, 3u, 4u})
            for (const bool big : {false, true}) {
                SCOPED_TRACE(fmt::format("{} bits, {} channels, big-endian: {}", bits, channels, big));
                const auto samples = ramp(w * h * channels, bits == 8 ? 255 : 65535);
                std::string strip;
                for (const uint16_t sample : samples) {
                    std::string bytes = Bytes().put(sample).text.substr(0, bits == 8 ? 1 : 2);
                    if (bits == 32) bytes = Bytes().put(float(sample)).text;
                    if (big) std::reverse(bytes.begin(), bytes.end());
                    strip += bytes;
                }
                auto entries = tiff_entries(w, h, channels, bits);
                if (channels % 2 == 1) std::erase_if(entries, [](const TiffEntry& e) { return e.tag == 338; });
                write_bytes(file, encode_tiff(entries, strip, big));
                const ImageFile image = read_image(file, true);
                ASSERT_EQ(image.bits, int(bits));
                ASSERT_EQ(image.alpha.size(), channels % 2 == 0 ? w * h : 0);
                for (size_t i = 0; i < w * h; ++i)
                    for (size_t c = 0; c < 3; ++c) {
                        const uint16_t expected = samples[i * channels + (channels >= 3 ? c : 0)];
                        const size_t at = 3 * i + c;
                        EXPECT_EQ(bits == 8    ? image.rgb8[at]
                                  : bits == 16 ? image.rgb16[at]
                                               : image.rgb32[at],
                                  expected);
                    }
            }
}

TEST_F(Images, BadTiffsAreRefused) {
    const fs::path file = root_ / "x.tif";
    const auto with = [&](uint16_t tag, std::vector<uint32_t> values) {
        auto entries = tiff_entries(8, 8, 3, 8);
        std::erase_if(entries, [](const TiffEntry& e) { return e.tag == 338; });
        const auto at = std::find_if(entries.begin(), entries.end(), [&](const TiffEntry& e) { return e.tag >= tag; });
        if (at != entries.end() && at->tag == tag)
            at->values = values;
        else
            entries.insert(at, {tag, 4, values});
        return encode_tiff(entries, std::string(192, '\x77'));
    };
    const auto refused = [&](const std::string& bytes) {
        write_bytes(file, bytes);
        return complaint([&] { read_image(file, true); });
    };
    const std::string good = with(256, {8});
    write_bytes(file, good);
    EXPECT_EQ(read_image(file).rgb8, std::vector<uint8_t>(192, 0x77));
    // Entries that the pixels do not need may point anywhere.
    write_bytes(file, with(34665, {8}));
    EXPECT_EQ(read_image(file).rgb8, std::vector<uint8_t>(192, 0x77));

    expect_in("sides run from 1", refused(with(257, {0})));
    expect_in("sides run from 1", refused(with(257, {4000000000u})));
    expect_in("channels of 1 bits", refused(with(258, {1, 1, 1})));
    expect_in("channels that differ", refused(with(258, {8, 16, 8})));
    expect_in("another number of TIFF channels", refused(with(258, {8})));
    expect_in("photometric interpretation 6", refused(with(262, {6})));
    expect_in("compression 9", refused(with(259, {9})));
    expect_in("photometric interpretation 6", refused(with(262, {6})));
    expect_in("within a TIFF strip", refused(with(273, {700})));
    expect_in("within a TIFF strip", refused(with(279, {4000000000u})));
    expect_in("another number of TIFF strips", refused(with(273, {512, 512})));
    expect_in("another number of TIFF strips", refused(with(278, {4})));
    expect_in("strips or tiles without pixels", refused(with(278, {0})));
    expect_in("channels: 200", refused(with(277, {200})));
    expect_in("planar configuration 3", refused(with(284, {3})));
    expect_in("neither strips nor tiles", refused(with(324, {512})));
    expect_in("convert the image to PNG", refused(with(339, {2, 2, 2})));
    for (size_t size = 0; size < good.size(); ++size) refused(good.substr(0, size));
}

// ---- OpenEXR, PFM ----

std::vector<float> float_ramp(size_t count) {
    std::vector<float> values(count);
    for (size_t i = 0; i < count; ++i) values[i] = float(i) * 0.37f - 3;
    return values;
}

TEST_F(Images, FloatFilesAreReadWholeOrRefused) {
    const auto values = float_ramp(6 * 5 * 3);
    const std::map<std::string, std::string> files = {{"x.exr", encode_exr(6, 5, values, 5, 4)},
                                                      {"x.pfm", encode_pfm(6, 5, values)}};
    for (const auto& [name, whole] : files) {
        SCOPED_TRACE(name);
        const fs::path file = root_ / name;
        write_bytes(file, whole);
        EXPECT_EQ(read_image(file, true).rgb32, values);
        expect_in("convert the image to PNG", complaint([&] { read_image(file); }));
        for (size_t size = 0; size < whole.size(); ++size) {
            write_bytes(file, whole.substr(0, size));
            expect_in(name, complaint([&] { read_image(file, true); }));
        }
    }
}

TEST_F(Images, PfmHeaders) {
    const fs::path file = root_ / "x.pfm";
    const auto pixel = [](float v) { return Bytes().put(v).text; };
    write_bytes(file, "Pf # grey\n1 2\n-2\n" + pixel(3) + pixel(4));
    EXPECT_EQ(read_image(file, true).rgb32, (std::vector<float>{8, 8, 8, 6, 6, 6}));
    write_bytes(file, std::string("Pf\n1 1\n1.0\n") + '\x3f' + '\x80' + '\0' + '\0');  // big-endian
    EXPECT_EQ(read_image(file, true).rgb32, (std::vector<float>{1, 1, 1}));
    for (const char* head : {"Pf\n1\n", "Pf\n-1 1 -1\n", "Pf\n1 1 0\n", "Pf\n1 1 nan\n", "Pf\n1 x -1\n", "Pf\n1 1 -1",
                             "Pf\n99999999999 1 -1\n", "Pf\n30000 30000 -1\n", "Pf #", "Pf\n1 2 -1\n"}) {
        SCOPED_TRACE(head);
        write_bytes(file, head + std::string(4, '\1'));
        expect_in("truncated or corrupt", complaint([&] { read_image(file, true); }));
    }
}

// ---- What no file may do ----

TEST_F(Images, HeadersThatPromiseTooMuchTakeNoMemory) {
    auto tiff = tiff_entries(30000, 30000, 3, 8);
    std::erase_if(tiff, [](const TiffEntry& e) { return e.tag == 338 || e.tag == 279; });
    tiff.insert(tiff.end() - 1, {279, 4, {64}});
    std::string jpeg = "\xff\xd8\xff\xc0";
    jpeg += std::string("\0\x11\x08\x7f\x00\x7f\x00\3\1\x11\0\2\x11\0\3\x11\0", 17) + std::string(100, '\0');
    const std::map<std::string, std::string> files = {
        {"x.png", plain_png(20000, 20000, 8, 2, "")},
        {"x.tif", encode_tiff(tiff, std::string(64, '\0'))},
        {"x.exr", encode_exr(6, 5, float_ramp(90), 15999, 15999)},
        {"high.exr", encode_exr(6, 5, float_ramp(90), 5, 2147483646)},
        {"x.jpg", jpeg},
        {"x.pfm", "PF\n30000 30000\n-1\n"},
    };
    struct rusage before = {}, after = {};
    getrusage(RUSAGE_SELF, &before);
    for (const auto& [name, bytes] : files) {
        SCOPED_TRACE(name);
        const fs::path file = root_ / name;
        write_bytes(file, bytes);
        expect_in(name, complaint([&] { read_image(file, true); }));
        expect_in(name, complaint([&] { read_mask(file); }));
    }
    getrusage(RUSAGE_SELF, &after);
    EXPECT_LT(after.ru_maxrss - before.ru_maxrss, 100 << 10);  // KiB; the smallest of these would be 1.2 GB
}

TEST_F(Images, TheSizeIsToldBeforeThePixelsAreRead) {
    struct Seen {};
    const auto check = [](int width, int height) {
        EXPECT_EQ(width, 700);
        EXPECT_EQ(height, 500);
        throw Seen();
    };
    write_bytes(root_ / "x.png", plain_png(700, 500, 8, 2, "no pixels"));
    EXPECT_THROW(read_image(root_ / "x.png", false, check), Seen);
    EXPECT_THROW(read_mask(root_ / "x.png", check), Seen);
}

TEST_F(Images, OtherFormatsAreRefused) {
    const std::vector<std::array<std::string, 3>> files = {
        {"x.bmp", "BM" + std::string(100, '\1'), "a BMP picture"},
        {"x.gif", "GIF89a" + std::string(100, '\1'), "a GIF picture"},
        {"x.png", "RIFF" + std::string(100, '\1'), "neither PNG, JPEG"},  // not the name decides
        {"x.hdr", "#?RADIANCE\n" + std::string(100, '\n'), "a Radiance picture"},
    };
    for (const auto& [name, bytes, kind] : files) {
        const fs::path file = root_ / name;
        write_bytes(file, bytes);
        expect_in(name + ": " + kind, complaint([&] { read_image(file, true); }));
        expect_in("convert", complaint([&] { read_mask(file); }));
    }
    expect_in("neither PNG, JPEG, TIFF, OpenEXR, HEIF nor PFM, or", complaint([&] { read_image(root_ / "x.png"); }));
    expect_in("it is a folder", complaint([&] { read_image(root_); }));
    ASSERT_EQ(mkfifo((root_ / "pipe.png").c_str(), 0600), 0);
    expect_in("it is a pipe", complaint([&] { read_image(root_ / "pipe.png"); }));
    fs::create_symlink("loop.png", root_ / "loop.png");
    expect_in("symbolic links", complaint([&] { read_image(root_ / "loop.png"); }));
    expect_in("too long", complaint([&] { read_image(root_ / std::string(300, 'x')); }));
}

TEST(ImageFormats, AnEndingBelongsToOneFormat) {
    std::set<std::string_view> endings;
    for (const ImageFormat& format : image_formats())
        for (const std::string_view ending : format.endings) {
            EXPECT_TRUE(endings.insert(ending).second) << ending;
            EXPECT_EQ(format_of_name("a.b" + std::string(ending)), &format);
        }
    EXPECT_EQ(format_of_name("A.JpEg"), format_of_name("b.jpg"));
    for (const char* name : {"png", "a.gif", "a.png.bak", ".png", ""}) EXPECT_EQ(format_of_name(name), nullptr) << name;
}

TEST(ImageFormats, TheCaptureScriptCountsThoseThatColmapTakes) {
    std::string endings;
    for (const ImageFormat& format : image_formats())
        for (const std::string_view ending : format.endings)
            if (format.colmap) endings += (endings.empty() ? "" : " ") + std::string(ending.substr(1));
    expect_in("\nendings=\"" + endings + "\" ", read_bytes(RADIAFIT_SOURCE_DIR "/datasets/scripts/capture.sh"));
}

// A small file may hold image data for hours behind its last row.
TEST_F(Images, PngDataBehindTheLastRow) {
    const fs::path file = root_ / "x.png";
    write_bytes(file, plain_png(2, 1, 8, 0, stored_zlib(std::string("\0\x40\x80", 3) + std::string(1000, '\1'))));
    EXPECT_EQ(read_image(file).rgb8, (std::vector<uint8_t>{64, 64, 64, 128, 128, 128}));
    write_bytes(file, plain_png(2, 1, 8, 0, stored_zlib(std::string(300000, '\0'))));
    expect_in("more image data than the picture has room for", complaint([&] { read_image(file); }));
}

TEST_F(Images, LibrariesPrintNothing) {
    auto tiff = tiff_entries(8, 8, 1, 8);
    std::erase_if(tiff, [](const TiffEntry& e) { return e.tag == 338; });
    tiff[3].values = {8};  // deflate, of bytes that are none
    const std::map<std::string, std::string> files = {
        {"x.png", plain_png(8, 8, 8, 2, "this is no zlib stream")},
        {"short.png", plain_png(8, 8, 8, 2, stored_zlib(std::string(30, '\0')))},
        {"filter.png", plain_png(1, 1, 8, 0, stored_zlib("\x9\x9"))},
        {"x.tif", encode_tiff(tiff, std::string(64, '\x55'))},
        {"x.exr", encode_exr(6, 5, float_ramp(90), 5, 400)},
    };
    ::testing::internal::CaptureStderr();
    ::testing::internal::CaptureStdout();
    for (const auto& [name, bytes] : files) {
        SCOPED_TRACE(name);
        const fs::path file = root_ / name;
        write_bytes(file, bytes);
        expect_in("truncated or corrupt", complaint([&] { read_image(file, true); }));
    }
    EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
    EXPECT_EQ(::testing::internal::GetCapturedStdout(), "");
}

TEST_F(Images, DamageAnywhereIsRefusedOrRead) {
    auto tiff = tiff_entries(6, 5, 3, 8);
    std::erase_if(tiff, [](const TiffEntry& e) { return e.tag == 338; });
    const std::map<std::string, std::string> files = {
        {"x.tif", encode_tiff(tiff, std::string(90, '\x55'))},
        {"x.exr", encode_exr(6, 5, float_ramp(90), 5, 4)},
        {"x.pfm", encode_pfm(6, 5, float_ramp(90))},
    };
    std::mt19937 random(7);
    for (const auto& [name, whole] : files)
        for (size_t at = 0; at < whole.size(); ++at) {
            SCOPED_TRACE(fmt::format("{} at {}", name, at));
            std::string damaged = whole;
            damaged[at] = static_cast<char>(random());
            write_bytes(root_ / name, damaged);
            try {
                read_image(root_ / name, true);
            } catch (const UserError& error) {
                EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
            }
        }
}

}  // namespace
}  // namespace radiafit

// HEIC pictures: pixels upright, depths, alpha, what they say of colours, damage.
#include <fmt/format.h>

#include "capture/picture_colors.h"
#include "capture_fixture.h"
#include "heif_bytes.h"
#include "image/image_file.h"
#include "image/orientation.h"
#include "picture_bytes.h"

namespace radiafit {
using namespace tools;
namespace {

using namespace testing;

/// A slope in each channel, unlike in every corner.
double slope(int x, int y, int channel) {
    const double u = x / 63.0, v = y / 47.0;
    return channel == 0 ? 0.2 + 0.6 * u : channel == 1 ? 0.2 + 0.6 * v : channel == 2 ? 0.7 - 0.4 * u : v;
}

class Heif : public FolderTest {
protected:
    ImageFile read(const HeifOptions& options) {
        write_bytes(root_ / "x.heic", encode_heif(options, slope));
        return read_image(root_ / "x.heic");
    }
    std::string refusal(const std::string& bytes) {
        write_bytes(root_ / "x.heic", bytes);
        return complaint([&] { read_image(root_ / "x.heic"); });
    }
};

TEST_F(Heif, PixelsAreUprightWithinWhatCompressionLoses) {
    for (int orientation = 1; orientation <= 8; ++orientation) {
        HeifOptions options;
        options.orientation = heif_orientation(orientation);
        const ImageFile image = read(options);
        const bool swapped = swaps_sides(orientation);
        ASSERT_EQ(image.width, swapped ? 48 : 64);
        ASSERT_EQ(image.height, swapped ? 64 : 48);
        EXPECT_EQ(image.orientation, 1);
        EXPECT_STREQ(image.format, "HEIF");
        double worst = 0;
        for (int y = 0; y < image.height; ++y)
            for (int x = 0; x < image.width; ++x) {
                const StoredPlace from = stored_place(orientation, size_t(x), size_t(y), 64, 48);
                for (int c = 0; c < 3; ++c)
                    worst = std::max(worst, std::abs(image.rgb8[size_t((y * image.width + x) * 3 + c)] -
                                                     255 * slope(int(from.x), int(from.y), c)));
            }
        EXPECT_LT(worst, 5) << orientation;
    }
}

TEST_F(Heif, DepthsAlphaAndTheOtherCodec) {
    HeifOptions options;
    options.bits = 10;
    ImageFile image = read(options);
    ASSERT_EQ(image.bits, 16);
    EXPECT_FALSE(image.linear);
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(image.rgb16[size_t((20 * 64 + 30) * 3 + c)] / 65535.0, slope(30, 20, c), 0.01);
    options = {};
    options.alpha = true;
    image = read(options);
    ASSERT_EQ(image.alpha.size(), 64u * 48);
    for (const int y : {2, 24, 45}) EXPECT_NEAR(image.alpha[size_t(y) * 64 + 9] / 255.0, slope(9, y, 3), 0.02);
    EXPECT_NEAR(image.rgb8[(24 * 64 + 9) * 3] / 255.0, slope(9, 24, 0), 0.02);
    options = {};
    options.format = heif_compression_AV1;
    image = read(options);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(image.rgb8[size_t((20 * 64 + 30) * 3 + c)] / 255.0, slope(30, 20, c), 0.02);
}

TEST_F(Heif, ColoursAsTheFileSays) {
    using Kind = ColorReading::Kind;
    const auto reading = [&](const HeifOptions& options) {
        ImageFile image = read(options);
        return convert_colors(image);
    };
    HeifOptions options;
    options.profile = display_p3().encode();
    EXPECT_EQ(read(options).colors.profile, options.profile);
    EXPECT_EQ(reading(options).kind, Kind::converted);
    expect_in("Display P3", reading(options).by);
    options = {};
    options.bits = 10;  // 16 bits that nothing calls sRGB would pass for linear light
    EXPECT_EQ(reading(options).kind, Kind::srgb);
    options.primaries = 1;
    EXPECT_EQ(reading(options).kind, Kind::srgb);
    options.transfer = 8;
    EXPECT_EQ(reading(options).kind, Kind::linear);
    // Display P3 by numbers is Display P3 by profile.
    HeifOptions by_profile, by_numbers;
    by_profile.profile = display_p3().encode();
    by_numbers.primaries = 12;
    ImageFile profile = read(by_profile), numbers = read(by_numbers);
    EXPECT_EQ(convert_colors(profile).kind, Kind::converted);
    EXPECT_EQ(convert_colors(numbers).kind, Kind::converted);
    int worst = 0;
    for (size_t i = 0; i < profile.rgb8.size(); ++i)
        worst = std::max(worst, std::abs(profile.rgb8[i] - numbers.rgb8[i]));
    EXPECT_LE(worst, 3);
    for (const uint16_t transfer : {16, 18}) {
        options.transfer = transfer;
        expect_in("high dynamic range", refusal(encode_heif(options, slope)));
    }
}

TEST_F(Heif, DamagedFilesAreRefused) {
    const std::string whole = encode_heif({}, slope);
    for (size_t size = 12; size < whole.size(); size += 7)
        expect_in("truncated or corrupt image", refusal(whole.substr(0, size)));
}

}  // namespace
}  // namespace radiafit

// `import lights` as a whole: a Lambertian sphere and a flat sample rendered here, bad captures, and the real ones
// where they are at hand.
#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <limits>
#include <random>

#include "capture/import_lights.h"
#include "capture/light_file.h"
#include "capture/normal_file.h"
#include "capture_fixture.h"
#include "dataset/dataset.h"
#include "dataset/image_stream.h"

namespace radiafit {
namespace {

using namespace testing;

constexpr float nan_value = std::numeric_limits<float>::quiet_NaN();

class LightsTest : public FolderTest {
protected:
    static constexpr int width = 24, height = 20, count = 10;
    static constexpr size_t pixels = size_t(width) * height;

    LightsTest() {
        options_.images = root_ / "images";
        options_.lights = root_ / "lights.txt";
        std::mt19937 random(5);
        const auto uniform = [&](double a, double b) { return std::uniform_real_distribution<double>(a, b)(random); };
        for (int i = 0; i < count; ++i) {
            lights_.push_back(Vec3d(uniform(-1, 1), uniform(-1, 1), uniform(0.3, 1)).normalized());
            intensities_.push_back({uniform(0.5, 1), uniform(0.5, 1), uniform(0.5, 1)});
        }
        for (size_t p = 0; p < pixels; ++p) {
            // The upper half of a sphere of radius 9 around the images' middle; y is up, rows go down.
            const double x = (double(p % width) + 0.5 - width / 2.0) / 9,
                         y = (height / 2.0 - double(p / width) - 0.5) / 9;
            const bool inside = x * x + y * y < 1;
            inside_.push_back(inside);
            normals_.push_back(inside ? Vec3f(float(x), float(y), float(std::sqrt(1 - x * x - y * y))) : Vec3f::Zero());
            albedo_.push_back({uniform(0.1, 1), uniform(0.1, 1), uniform(0.1, 1)});
        }
    }

    Vec3d radiance(int light, size_t pixel) const {
        const double cosine = std::max(0.0, normals_[pixel].cast<double>().dot(lights_[size_t(light)]));
        return cosine * albedo_[pixel].cwiseProduct(intensities_[size_t(light)]);
    }
    std::vector<float> linear_image(int light) const {
        std::vector<float> values;
        for (size_t p = 0; p < pixels; ++p)
            for (int c = 0; c < 3; ++c) values.push_back(float(radiance(light, p)[c]));
        return values;
    }
    static std::vector<uint16_t> rounded(const std::vector<float>& values, double largest) {
        std::vector<uint16_t> stored;
        for (const float v : values) stored.push_back(static_cast<uint16_t>(std::lround(largest * double(v))));
        return stored;
    }
    static std::string name(int i, const char* ending = ".png") { return fmt::format("{:02}{}", i, ending); }

    void write_text() {
        std::string lights, intensities;
        for (int i = 0; i < count; ++i) {
            const Vec3d &l = lights_[size_t(i)], &e = intensities_[size_t(i)];
            lights += fmt::format("{} {} {}\n", 7 * l.x(), 7 * l.y(), 7 * l.z());  // any length will do
            intensities += fmt::format("{}, {}, {}\n", e.x(), e.y(), e.z());
        }
        write_bytes(options_.lights, "# towards the lamps\n" + lights);
        write_bytes(options_.intensities = root_ / "intensities.txt", intensities);
    }
    void write_shape() {
        std::vector<float> normals;
        std::vector<uint16_t> mask;
        for (size_t p = 0; p < pixels; ++p) {
            for (int c = 0; c < 3; ++c) normals.push_back(normals_[p][c]);
            mask.push_back(inside_[p] ? 255 : 0);
        }
        write_bytes(options_.normals = root_ / "normals.pfm", encode_pfm(width, height, normals));
        write_bytes(options_.mask = root_ / "mask.png", encode_png(width, height, 1, 8, mask));
    }
    /// The sphere under ten lamps, 16 bits.
    void write_sphere() {
        for (int i = 0; i < count; ++i)
            write_bytes(options_.images / name(i), encode_png(width, height, 3, 16, rounded(linear_image(i), 65535)));
        write_text();
        write_shape();
    }
    Dataset import() {
        report_ = import_lights(options_, root_ / "set");
        return open_dataset(root_ / "set");
    }
    std::string refused() {
        const std::string text = complaint([&] { import_lights(options_, root_ / "set"); });
        EXPECT_FALSE(fs::exists(root_ / "set"));
        return text;
    }

    LightImportOptions options_;
    LightImportReport report_;
    std::vector<Vec3d> lights_, intensities_, albedo_;
    std::vector<Vec3f> normals_;
    std::vector<bool> inside_;
};

TEST_F(LightsTest, ASphereReadsBack) {
    write_sphere();
    options_.depth = 16;
    const Dataset set = import();
    EXPECT_TRUE(report_.notes.empty());
    EXPECT_EQ(report_.training, 8u);
    EXPECT_EQ(report_.held_out, 2u);
    EXPECT_EQ(set.encoding, Encoding::u16_linear);
    ASSERT_EQ(set.views.size(), size_t(count));
    const GridAtlas atlas = make_atlas(set.grid);
    for (uint32_t t = 0; t < atlas.texel_count(); ++t) {
        ASSERT_EQ(atlas.usable(t), inside_[t]);
        if (!inside_[t]) continue;
        EXPECT_LT((atlas.normal(t) - normals_[t]).norm(), 1e-6f);
        const Vec3f sphere = 9 * normals_[t];
        EXPECT_NEAR(atlas.position(t).x(), sphere.x(), 1e-5f);
        EXPECT_NEAR(atlas.position(t).y(), sphere.y(), 1e-5f);
        EXPECT_EQ(atlas.position(t).z(), 0);
    }
    ImageStream stream(set, StreamSource::disk);
    TargetImage image;
    std::vector<float> values;
    for (int i = 0; i < count; ++i) {
        const View& view = set.views[size_t(i)];
        EXPECT_EQ(view.name, name(i));
        EXPECT_EQ(view.held_out, i % 8 == 0);
        EXPECT_EQ(view.camera_direction, Vec3d(0, 0, 1));
        ASSERT_TRUE(view.light.has_value());
        EXPECT_EQ(view.light->kind, Light::Kind::distant);
        EXPECT_LT((view.light->place - lights_[size_t(i)]).norm(), 1e-12);
        EXPECT_LT((view.light->intensity - intensities_[size_t(i)]).norm(), 1e-12);
        stream.load(uint32_t(i), image);
        stream.load_values(uint32_t(i), values);
        for (uint32_t t = 0; t < atlas.texel_count(); ++t) {
            ASSERT_EQ(image.masked_in(t), inside_[t]);
            if (!inside_[t]) continue;
            // As a fit sees it: irradiance * model, all of it from the dataset.
            const Vec3d x = atlas.position(t).cast<double>(), n = atlas.normal(t).cast<double>();
            const double cosine = std::max(0.0, n.dot(view.light->direction_from(x)));
            for (int c = 0; c < 3; ++c)
                EXPECT_NEAR(double(values[3 * t + uint32_t(c)]),
                            view.light->irradiance_at(x)[c] * albedo_[t][c] * cosine, 0.5 / 65535 + 1e-6);
        }
    }
}

TEST_F(LightsTest, FloatsAreKeptExactlyAndNotANumberIsMaskedOutOrRefused) {
    write_text();
    for (int i = 0; i < count; ++i)
        write_bytes(options_.images / name(i, ".pfm"), encode_pfm(width, height, linear_image(i)));
    options_.holdout = "none";
    const Dataset set = import();
    EXPECT_EQ(set.encoding, Encoding::f32_linear);
    EXPECT_TRUE(set.grid.texel_normals.empty());
    EXPECT_EQ(set.split(true).size(), 0u);
    std::vector<float> values;
    for (int i = 0; i < count; ++i) {
        ImageStream(set, StreamSource::disk).load_values(uint32_t(i), values);
        EXPECT_EQ(values, linear_image(i));
    }

    fs::remove_all(root_ / "set");
    std::vector<float> broken = linear_image(6);
    broken[3 * (4 * width + 0) + 1] = nan_value;  // column 0, row 4: outside the sphere
    write_bytes(options_.images / name(6, ".pfm"), encode_pfm(width, height, broken));
    std::string text = refused();
    expect_in("06.pfm: the pixel at column 0, row 4 is not finite", text);
    expect_in("repair the image", text);
    write_shape();
    ImageStream(import(), StreamSource::disk).load_values(6, values);
    EXPECT_EQ(values[3 * (4 * width + 0) + 1], 0);
    fs::remove_all(root_ / "set");
    broken[3 * (10 * width + 12)] = std::numeric_limits<float>::infinity();
    write_bytes(options_.images / name(6, ".pfm"), encode_pfm(width, height, broken));
    expect_in("column 12, row 10", refused());
    options_.transfer = "srgb";
    expect_in("floats, which are linear", refused());
}

/// Photographs of a flat card with a lamp and a camera near it: places, fall-off, and the bytes as they were.
TEST_F(LightsTest, AFlatSampleWithNearLampAndCamera) {
    const std::vector<Vec3d> eyes = {{1.0125, 0.2928, 16.7058}, {-3, 2, 17}, {0, 0, 18}};
    const std::vector<Vec3d> lamps = {{1, 0, 16}, {-2.5, 2, 17.5}, {0, 0.25, 18}};
    const double side = 6.848, texel = side / width;
    std::string eye_lines, lamp_lines;
    std::mt19937 random(2);
    std::vector<std::vector<uint16_t>> stored(3);
    for (size_t i = 0; i < 3; ++i) {
        eye_lines += fmt::format("{},{},{}\n", eyes[i].x(), eyes[i].y(), eyes[i].z());
        lamp_lines += fmt::format("{} {} {}\r\n", lamps[i].x(), lamps[i].y(), lamps[i].z());
        for (size_t k = 0; k < 3 * pixels; ++k) stored[i].push_back(static_cast<uint16_t>(random() % 256));
        write_bytes(options_.images / name(int(i)), encode_png(width, height, 3, 8, stored[i]));
    }
    options_.lights.clear();
    write_bytes(options_.light_positions = root_ / "lamps.txt", lamp_lines);
    write_bytes(options_.camera_positions = root_ / "eyes.txt", eye_lines);
    write_bytes(options_.intensities = root_ / "power.txt", "500\n");
    options_.sample_width = side;
    options_.holdout = "every:3";
    const Dataset set = import();
    EXPECT_EQ(set.encoding, Encoding::u8_srgb);
    ASSERT_EQ(set.views.size(), 3u);
    const GridAtlas atlas = make_atlas(set.grid);
    const std::string bytes = read_bytes(set.folder / "images.bin");
    for (size_t i = 0; i < 3; ++i) {
        const View& view = set.views[i];
        EXPECT_EQ(view.held_out, i == 0);
        EXPECT_LT((view.camera.center() - eyes[i]).norm(), 1e-12);
        for (int row = 0; row < height; ++row)
            for (int column = 0; column < width; ++column) {
                const auto t = uint32_t(row * width + column);
                const Vec3d x((column + 0.5 - width / 2.0) * texel, (height / 2.0 - row - 0.5) * texel, 0);
                EXPECT_LT((atlas.position(t).cast<double>() - x).norm(), 1e-6);
                EXPECT_EQ(atlas.normal(t), Vec3f(0, 0, 1));
                EXPECT_TRUE(atlas.usable(t));
                EXPECT_LT((view.direction_to_camera(x) - (eyes[i] - x).normalized()).norm(), 1e-12);
                EXPECT_LT((view.light->direction_from(x) - (lamps[i] - x).normalized()).norm(), 1e-12);
                EXPECT_NEAR(view.light->irradiance_at(x)[1], 500 / (lamps[i] - x).squaredNorm(), 1e-12);
                const Vec3d pixel = view.camera.project(x);
                EXPECT_NEAR(pixel.x(), column + 0.5, 1e-9);
                EXPECT_NEAR(pixel.y(), row + 0.5, 1e-9);
            }
        for (size_t k = 0; k < 3 * pixels; ++k)
            ASSERT_EQ(static_cast<uint8_t>(bytes[view.pixel_offset + k]), stored[i][k]);
    }

    fs::remove_all(root_ / "set");
    options_.transfer = "linear";
    EXPECT_EQ(import().encoding, Encoding::u8_linear);
    fs::remove_all(root_ / "set");
    options_.sample_width = 0;
    expect_in("--sample-width", refused());
    options_.sample_width = side;
    write_bytes(options_.camera_positions, "1 2 3\n1 2 3\n");
    expect_in("eyes.txt: 2 camera positions, but there are 3 images", refused());
    write_bytes(options_.camera_positions, "1 2 -3\n");
    expect_in("eyes.txt: the camera at (1, 2, -3) doesn't stand in front", refused());
}

TEST_F(LightsTest, SixteenBitSrgbBecomesLinearAndAlphaMasks) {
    const std::vector<uint16_t> rgba = [] {
        std::vector<uint16_t> v(4 * pixels, 32768);
        for (size_t p = 0; p < pixels; ++p) v[4 * p + 3] = p % 3 ? 65535 : 0;
        return v;
    }();
    for (int i = 0; i < count; ++i) write_bytes(options_.images / name(i), encode_png(width, height, 4, 16, rgba));
    write_text();
    options_.transfer = "srgb";
    const Dataset set = import();
    EXPECT_EQ(set.encoding, Encoding::u16_linear);
    ImageStream stream(set, StreamSource::disk);
    TargetImage image;
    std::vector<float> values;
    stream.load(0, image);
    stream.load_values(0, values);
    for (size_t p = 0; p < pixels; ++p) {
        EXPECT_EQ(image.masked_in(p), p % 3 != 0);
        EXPECT_NEAR(double(values[3 * p]), srgb_decode(32768.0 / 65535), 1.0 / 65535);
    }
    EXPECT_TRUE(set.grid.texel_normals.empty());  // another image may see what this one's alpha leaves out
}

// ---- Light files ----

TEST_F(LightsTest, AnLpFileNamesItsImages) {
    write_sphere();
    fs::rename(options_.images / name(3), options_.images / "the third.png");
    fs::remove(options_.lights);
    options_.lights = root_ / "dome.LP";
    std::string lines = "4\r\n";
    for (const int i : {5, 3, 9, 1}) {
        const Vec3d& l = lights_[size_t(i)];
        const std::string image = i == 3 ? "C:\\RTI data\\the third.png" : i == 9 ? "shots/09.png" : name(i);
        lines += fmt::format("{}\t{} {} {}\r\n", image, l.x(), l.y(), l.z());
    }
    write_bytes(options_.lights, lines);
    options_.intensities.clear();
    options_.holdout = "every:2";
    const Dataset set = import();
    ASSERT_EQ(set.views.size(), 4u);
    EXPECT_EQ(set.views[1].name, "the third.png");
    EXPECT_EQ(set.views[2].name, "09.png");
    EXPECT_TRUE(set.views[0].held_out && !set.views[1].held_out && set.views[2].held_out);
    EXPECT_LT((set.views[1].light->place - lights_[3]).norm(), 1e-12);
    EXPECT_LT((set.views[2].light->place - lights_[9]).norm(), 1e-12);
    EXPECT_EQ(set.views[2].light->intensity, Vec3d::Ones());
    std::vector<float> values;
    ImageStream(set, StreamSource::disk).load_values(1, values);
    for (size_t k = 0; k < values.size(); ++k)
        EXPECT_NEAR(values[k], linear_image(3)[k], 0.5 / 65535 + 1e-6) << k;  // the third image, not the fourth line's
    ASSERT_EQ(report_.notes.size(), 1u);
    expect_in("6 images of", report_.notes[0]);

    fs::remove_all(root_ / "set");
    const auto with = [&](const std::string& text) {
        write_bytes(options_.lights, text);
        return refused();
    };
    expect_in("dome.LP: says 5 images, but lists 4: mend", with("5" + lines.substr(1)));
    expect_in("dome.LP: says 3 images, but lists 4: mend", with("3" + lines.substr(1)));
    expect_in("dome.LP:1: the number of images is '05.png 1 2 3'", with("05.png 1 2 3\n"));
    expect_in("dome.LP:0: the file is empty", with(""));
    expect_in("dome.LP:3: the light's vector is 0 0 0", with("2\n05.png 0 0 1\n03.png 0 -0 0\n"));
    expect_in("dome.LP:3: image '05.png' stands here a second time", with("2\n05.png 0 0 1\n05.png 0 1 1\n"));
    expect_in("dome.LP:2: light direction is 'nan', which is not finite", with("1\n05.png 0 nan 1\n"));
    expect_in("dome.LP:2: an .lp file's line takes", with("1\n05.png 0 1\n"));
    expect_in("images/77.png: no such image, but", with("2\n01.png 0 0 1\n77.png 0 0 1\n"));
    write_bytes(options_.lights, "1\n05.png 0 0 1\n");
    write_bytes(options_.names = root_ / "names.txt", "05.png\n");
    expect_in("names its images itself", refused());
}

TEST_F(LightsTest, NamesGiveTheOrder) {
    write_sphere();
    std::string names;
    for (int i = count; i-- > 0;) names += name(i) + "\n";
    write_bytes(options_.names = root_ / "names.txt", names);
    options_.holdout = (root_ / "held.txt").string();
    write_bytes(options_.holdout, "04.png\n");
    const Dataset set = import();
    for (int i = 0; i < count; ++i) {
        EXPECT_EQ(set.views[size_t(i)].name, name(count - 1 - i));
        EXPECT_EQ(set.views[size_t(i)].held_out, i == count - 1 - 4);
        EXPECT_LT((set.views[size_t(i)].light->place - lights_[size_t(i)]).norm(), 1e-12);
    }
}

// ---- Bad captures ----

TEST_F(LightsTest, CountsMustAgree) {
    write_sphere();
    fs::remove(options_.images / name(9));
    std::string text = refused();
    expect_in("lights.txt: 10 lights, but", text);
    expect_in("holds 9 images", text);
    expect_in("one line per image", text);
    write_sphere();
    write_bytes(options_.intensities, "1\n2\n");
    expect_in("intensities.txt: 2 intensities, but there are 10 images", refused());
    fs::remove_all(options_.images);
    expect_in("images: no such folder", refused());
    fs::create_directories(options_.images);
    expect_in("images: no images here", refused());
}

TEST_F(LightsTest, LightsMustPointSomewhere) {
    write_sphere();
    const std::string lights = read_bytes(options_.lights);
    write_bytes(options_.lights, "0 0 0\n" + lights);
    expect_in("lights.txt:1: the light's vector is 0 0 0", refused());
    write_bytes(options_.lights, "1 2\n" + lights);
    expect_in("lights.txt:1: a light takes three numbers, here are 2", refused());
    write_bytes(options_.lights, lights);
    for (const char* bad : {"0 0 0\n", "0\n", "1 -1 1\n"}) {
        write_bytes(options_.intensities, bad);
        expect_in("intensities.txt:1: a light's intensity", refused());
    }
    options_.lights.clear();
    expect_in("--light-positions", refused());
}

TEST_F(LightsTest, ImagesMustBeAlike) {
    write_sphere();
    write_bytes(options_.images / name(4), encode_png(width, height, 3, 8, std::vector<uint16_t>(3 * pixels, 9)));
    expect_in("04.png: has 8-bit channels, but", refused());
    write_bytes(options_.images / name(4), encode_png(height, width, 3, 16, std::vector<uint16_t>(3 * pixels, 9)));
    expect_in("04.png: 20 x 24 pixels, but", refused());
    for (int i = 0; i < count; ++i)
        write_bytes(options_.images / name(i), encode_png(width, height, 3, 8, std::vector<uint16_t>(3 * pixels, 9)));
    options_.depth = 16;
    const std::string text = refused();
    expect_in("00.png: has 8-bit channels, but --depth 16 was declared", text);
    expect_in("export the image again", text);
    options_.depth = 0;
    options_.transfer = "gamma";
    expect_in("--transfer gamma", refused());
}

TEST_F(LightsTest, NormalsAndMaskMustFit) {
    write_sphere();
    const fs::path normals = options_.normals, mask = options_.mask;
    write_bytes(normals, encode_pfm(height, width, std::vector<float>(3 * pixels, 1)));
    std::string text = refused();
    expect_in("normals.pfm: normals for 20 x 24 pixels, but the images have 24 x 20", text);
    expect_in("at their size", text);
    const std::string whole = encode_pfm(width, height, std::vector<float>(3 * pixels, 1));
    write_bytes(normals, whole.substr(0, whole.size() - 12));
    expect_in("normals.pfm: truncated or corrupt image (it cannot be read whole)", refused());
    std::vector<float> broken(3 * pixels, 0.57f);
    broken[3 * (5 * width + 2) + 2] = nan_value;
    write_bytes(normals, encode_pfm(width, height, broken));
    expect_in("normals.pfm: the normal at column 2, row 5 is not finite", refused());
    write_bytes(normals, encode_pfm(width, height, std::vector<float>(3 * pixels, 0)));
    expect_in("normals.pfm: no pixel has a normal", refused());
    write_shape();
    write_bytes(mask, encode_png(height, width, 1, 8, std::vector<uint16_t>(pixels, 255)));
    expect_in("mask.png: 20 x 24 pixels, but the images have 24 x 20", refused());
    write_bytes(mask, encode_png(width, height, 1, 8, std::vector<uint16_t>(pixels, 0)));
    expect_in("mask.png: the mask is black throughout", refused());
    // Not wrong, but worth a word: a hole in the scan, and a flipped axis.
    options_.mask.clear();
    import();
    ASSERT_EQ(report_.notes.size(), 1u);
    expect_in("pixels have no normal", report_.notes[0]);
    options_.mask = mask;
    for (Vec3f& n : normals_) n.z() = -n.z();
    write_shape();
    import();
    ASSERT_EQ(report_.notes.size(), 1u);
    expect_in("face away", report_.notes[0]);
}

TEST_F(LightsTest, NormalPicturesOfIntegersAreHalvedAndShifted) {
    for (const int bits : {8, 16}) {
        const double largest = bits == 8 ? 255 : 65535;
        std::vector<uint16_t> stored;
        for (const Vec3f& n : normals_)
            for (int c = 0; c < 3; ++c)
                stored.push_back(
                    static_cast<uint16_t>(n == Vec3f::Zero() ? 0 : std::lround(largest * (double(n[c]) + 1) / 2)));
        write_bytes(root_ / "n.png", encode_png(width, height, 3, bits, stored));
        const NormalFile file = read_normal_file(root_ / "n.png");
        ASSERT_EQ(file.width, width);
        for (size_t p = 0; p < pixels; ++p) EXPECT_LT((file.normals[p] - normals_[p]).norm(), 2 / float(largest)) << p;
    }
}

// ---- The real captures ----

fs::path captures() {
    const char* folder = std::getenv("RADIAFIT_CAPTURES");
    return folder ? fs::path(folder) : fs::path(RADIAFIT_SOURCE_DIR) / "../shared/data";
}

/// Sum over every fifth texel (if usable), channels and images of (value - E albedo u_z^power)^2, relative to the
/// values' own, for the albedo that makes it least, over samples with u_z > 0. Power 1: Lambert.
double misfit(const Dataset& set, double power) {
    const GridAtlas atlas = make_atlas(set.grid);
    const size_t texels = atlas.texel_count();
    std::vector<double> ee(3 * texels), ev(3 * texels), vv(3 * texels);
    ImageStream stream(set, StreamSource::disk, TargetSpace::linear);
    std::vector<float> values;
    for (uint32_t i = 0; i < set.views.size(); ++i) {
        stream.load_values(i, values);
        for (uint32_t t = 0; t < texels; t += 5) {
            const Vec3d x = atlas.position(t).cast<double>();
            const double cosine = atlas.normal(t).cast<double>().dot(set.views[i].light->direction_from(x));
            if (!atlas.usable(t) || cosine <= 0) continue;
            const Vec3d e = std::pow(cosine, power) * set.views[i].light->irradiance_at(x);
            for (uint32_t c = 0; c < 3; ++c) {
                const double v = double(values[3 * t + c]);
                ee[3 * t + c] += e[c] * e[c], ev[3 * t + c] += e[c] * v, vv[3 * t + c] += v * v;
            }
        }
    }
    double wrong = 0, all = 0;
    for (size_t i = 0; i < ee.size(); ++i)
        if (ee[i] > 0) wrong += vv[i] - ev[i] * ev[i] / ee[i], all += vv[i];
    return wrong / all;
}

using RealLightsTest = FolderTest;

TEST_F(RealLightsTest, DiligentReadingImports) {
    const fs::path capture = captures() / "diligent_reading";
    if (!fs::exists(capture / "normal_gt.pfm"))
        GTEST_SKIP() << "no diligent_reading in " << captures() << ": set RADIAFIT_CAPTURES";
    LightImportOptions options;
    options.images = capture / "images";
    options.lights = capture / "light_directions.txt";
    options.names = capture / "filenames.txt";
    options.intensities = capture / "light_intensities.txt";
    options.mask = capture / "mask.png";
    options.normals = capture / "normal_gt.pfm";
    options.depth = 16;
    const LightImportReport report = import_lights(options, root_ / "reading");
    EXPECT_TRUE(report.notes.empty());
    EXPECT_EQ(report.held_out, 12u);
    EXPECT_EQ(report.training, 84u);
    Dataset set = open_dataset(root_ / "reading");
    EXPECT_EQ(set.grid.width, 219);
    EXPECT_EQ(set.grid.height, 232);
    // Any flipped axis makes shading and picture disagree.
    const double right = misfit(set, 1);
    for (int axis = 0; axis < 2; ++axis) {
        for (View& view : set.views) view.light->place[axis] *= -1;
        EXPECT_GT(misfit(set, 1), 1.3 * right) << axis;
        for (View& view : set.views) view.light->place[axis] *= -1;
    }
}

TEST_F(RealLightsTest, CardsBlueImports) {
    const fs::path capture = captures() / "cards_blue";
    if (!fs::exists(capture / "light_pos.txt"))
        GTEST_SKIP() << "no cards_blue in " << captures() << ": set RADIAFIT_CAPTURES";
    LightImportOptions options;
    options.images = capture / "images";
    options.light_positions = capture / "light_pos.txt";
    options.camera_positions = capture / "camera_pos.txt";
    options.intensities = capture / "light_power.txt";
    options.sample_width = 6.848;
    const LightImportReport report = import_lights(options, root_ / "cards");
    EXPECT_TRUE(report.notes.empty());
    EXPECT_EQ(report.training, 7u);
    Dataset set = open_dataset(root_ / "cards");
    EXPECT_EQ(set.grid.texel_count(), size_t(1024) * 1024);
    EXPECT_LT((set.views[8].camera.center() - set.views[8].light->place).norm(), 1e-9);  // a flash
    // A crude highlight, brightest where the flash stands above: it follows the flash along both axes.
    const double right = misfit(set, 40);
    for (int axis = 0; axis < 2; ++axis) {
        for (View& view : set.views) view.light->place[axis] *= -1;
        EXPECT_GT(misfit(set, 40), 1.3 * right) << axis;
        for (View& view : set.views) view.light->place[axis] *= -1;
    }
}

}  // namespace
}  // namespace radiafit

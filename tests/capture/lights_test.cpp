// `import lights` as a whole: a Lambertian sphere and a flat sample rendered here read back.
#include "base/statistics.h"
#include "capture/light_doubt.h"
#include "capture/light_file.h"
#include "capture/normal_file.h"
#include "dataset/image_stream.h"
#include "lights_fixture.h"
#include "model/photometric_stereo.h"

namespace radiafit {
using namespace tools;
namespace {

using namespace testing;

TEST_F(LightsTest, OtherAxesReadBack) {
    write_sphere();
    const Dataset right = import();
    EXPECT_EQ(light_doubt(right, options_.lights, false, "").value_or("none"), "none");
    for (Vec3d& l : lights_) l = Vec3d(-l.y(), l.x(), -l.z());  // as the file has it
    write_text();
    options_.light_axes = "y, -x, -z";
    const Dataset turned = import();
    expect_in("--light-axes y, -x, -z", turned.source);
    for (size_t i = 0; i < right.views.size(); ++i)
        EXPECT_LT((turned.views[i].light->place - right.views[i].light->place).norm(), 1e-12);
    options_.light_axes = "x,y,y";
    EXPECT_NE(complaint([&] { import(); }).find("'light_axes' x,y,y: give the file's axes"), std::string::npos);
}

TEST_F(LightsTest, ASphereReadsBack) {
    write_sphere();
    options_.depth = 16;
    const Dataset set = import();
    ASSERT_EQ(report_.notes.size(), 1u);
    expect_in("held-out images", report_.notes[0]);  // beyond the other lamps
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
    options_.normals = "flat";
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
    expect_in("'sample_width'", refused());
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
    options_.normals = "flat";
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

// ---- Normals from the lights ----

TEST_F(LightsTest, NormalsAreComputedFromTrainingImagesWhereNoneAreGiven) {
    write_sphere();
    options_.normals.clear();
    const auto angles = [&](const Dataset& set) {
        std::vector<double> degrees;
        for (size_t p = 0; p < pixels; ++p)
            if (inside_[p]) {
                const Vec3f& n = set.grid.texel_normals[p];
                EXPECT_NEAR(n.norm(), 1, 1e-5);
                degrees.push_back(180 / M_PI * std::acos(std::min(1.0, double(n.dot(normals_[p])))));
            } else {
                EXPECT_EQ(set.grid.texel_normals[p], Vec3f(Vec3f::Zero()));
            }
        return degrees;
    };
    const std::vector<double> exact = angles(import());
    EXPECT_TRUE(report_.computed_normals);
    EXPECT_LT(median(exact), 0.05);  // attached shadows and 16 bits
    ASSERT_FALSE(report_.remarks.empty());
    expect_in("computed from 8 training images", report_.remarks.back());

    // Held-out images have no say, whatever they show.
    for (const int i : {0, 8})
        write_bytes(options_.images / name(i), encode_png(width, height, 3, 16, std::vector<uint16_t>(3 * pixels, 9)));
    fs::remove_all(root_ / "set");
    EXPECT_EQ(angles(import()), exact);
}

TEST_F(LightsTest, LampsInOnePlaneTellNoNormals) {
    write_sphere();
    options_.normals.clear();
    std::string lines;
    for (int i = 0; i < count; ++i) lines += fmt::format("{} 0 1\n", i - 4.5);
    write_bytes(options_.lights, lines);
    const Dataset set = import();
    EXPECT_FALSE(report_.computed_normals);
    for (size_t p = 0; p < pixels; ++p)
        EXPECT_EQ(set.grid.texel_normals[p], inside_[p] ? Vec3f(Vec3f::UnitZ()) : Vec3f(Vec3f::Zero()));
    expect_in("tell none", report_.remarks.back());
}

/// One pixel, many lamps: highlights and cast shadows on a fifth of the samples hardly move the normal.
TEST(PhotometricStereo, OutliersHaveLittleSay) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> uniform(-1, 1);
    std::vector<Vec3d> lamps;
    for (int i = 0; i < 60; ++i) lamps.push_back(Vec3d(uniform(random), uniform(random), 1.2).normalized());
    std::vector<double> errors;
    for (int trial = 0; trial < 100; ++trial) {
        const Vec3d normal = Vec3d(0.5 * uniform(random), 0.5 * uniform(random), 1).normalized();
        std::vector<float> values;
        for (size_t i = 0; i < lamps.size(); ++i) {
            const double diffuse = 0.3 * std::max(0.0, normal.dot(lamps[i])) + 0.001 * uniform(random);
            values.push_back(float(i % 10 == 0 ? 2 * diffuse + 0.1 : i % 10 == 5 ? 0.3 * diffuse : diffuse));
        }
        values[7] = nan_value;
        const Vec3f found = photometric_normal(lamps, values);
        errors.push_back(180 / M_PI * std::acos(std::min(1.0, found.cast<double>().dot(normal))));
    }
    EXPECT_LT(median(errors), 0.2);
    EXPECT_LT(quantile(errors, 1), 1);
    EXPECT_EQ(photometric_normal(lamps, std::vector<float>(60, 0)), Vec3f(Vec3f::Zero()));
    EXPECT_FALSE(lamps_give_normals(std::vector<Vec3d>{Vec3d::UnitX(), Vec3d::UnitZ()}));
}

// ---- Size ----

TEST_F(LightsTest, MaxSizeAveragesLightMaskAndNormals) {
    write_sphere();
    options_.max_size = width / 2;
    for (const bool floats : {false, true}) {
        SCOPED_TRACE(floats);
        if (floats) {
            fs::remove_all(options_.images);
            for (int i = 0; i < count; ++i)
                write_bytes(options_.images / name(i, ".pfm"), encode_pfm(width, height, linear_image(i)));
        }
        const Dataset set = import();
        ASSERT_EQ(set.grid.width, width / 2);
        ASSERT_EQ(set.grid.height, height / 2);
        std::vector<float> values;
        ImageStream(set, StreamSource::disk).load_values(3, values);
        const std::vector<float> full = linear_image(3);
        for (int y = 0; y < height / 2; ++y)
            for (int x = 0; x < width / 2; ++x) {
                size_t inside = 0;
                Vec3f normal = Vec3f::Zero();
                float red = 0;
                for (int k = 0; k < 4; ++k) {
                    const size_t p = size_t((2 * y + k / 2) * width + 2 * x + k % 2);
                    inside += inside_[p];
                    normal += normals_[p];
                    red += full[3 * p] / 4;
                }
                const size_t texel = size_t(y * width / 2 + x);
                if (inside >= 2) {
                    EXPECT_NEAR(values[3 * texel], red, 2e-5f);
                }
                const Vec3f expected = inside >= 2 ? Vec3f(normal.normalized()) : Vec3f(Vec3f::Zero());
                EXPECT_LT((set.grid.texel_normals[texel] - expected).norm(), 1e-5f);
            }
        fs::remove_all(root_ / "set");
    }
    options_.max_size = -1;
    expect_in("'max_size' -1", refused());
}

TEST_F(LightsTest, WhatIsMaskedOutMayBeNotANumberAtAnySize) {
    write_sphere();
    const auto outside = size_t(std::find(inside_.begin(), inside_.end(), false) - inside_.begin());
    // Of the four pixels that one becomes, one is outside, on the sphere's edge.
    size_t edge = 0;
    for (size_t p = 0; p < pixels; ++p) {
        const size_t first = p / width / 2 * 2 * width + p % width / 2 * 2;
        const int inside = inside_[first] + inside_[first + 1] + inside_[first + width] + inside_[first + width + 1];
        if (!inside_[p] && inside == 3) edge = p;
    }
    ASSERT_NE(edge, 0u);
    fs::remove_all(options_.images);
    for (int i = 0; i < count; ++i) {
        std::vector<float> values = linear_image(i);
        values[3 * outside] = values[3 * edge + 1] = nan_value;
        write_bytes(options_.images / name(i, ".pfm"), encode_pfm(width, height, values));
    }
    options_.max_size = width / 2;
    const Dataset set = import();
    std::vector<float> values;
    ImageStream(set, StreamSource::disk).load_values(0, values);
    for (const float v : values) ASSERT_TRUE(std::isfinite(v));
    fs::remove_all(root_ / "set");
    options_.mask.clear();
    options_.normals = "flat";
    expect_in(fmt::format("column {}, row {} is not finite", outside % width, outside / width), refused());
}

TEST_F(LightsTest, AMaskThatVanishesInScalingIsRefused) {
    write_sphere();
    std::vector<uint16_t> dot(pixels, 0);
    dot[pixels / 2] = 255;
    write_bytes(options_.mask, encode_png(width, height, 1, 8, dot));
    options_.normals = "flat";
    import();
    fs::remove_all(root_ / "set");
    options_.max_size = 4;
    expect_in("nothing is left of the mask at 4 x 3 pixels: raise 'max_size'", refused());
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
    ASSERT_EQ(report_.notes.size(), 2u);
    expect_in("6 images of", report_.notes[0]);

    fs::remove_all(root_ / "set");
    const auto with = [&](const std::string& text) {
        write_bytes(options_.lights, text);
        return refused();
    };
    expect_in("dome.LP: says 5 images, but lists 4: correct", with("5" + lines.substr(1)));
    expect_in("dome.LP: says 3 images, but lists 4: correct", with("3" + lines.substr(1)));
    expect_in("dome.LP:1: the number of images is '05.png 1 2 3'", with("05.png 1 2 3\n"));
    expect_in("dome.LP:0: the file is empty", with(""));
    expect_in("dome.LP:3: the light's vector (0, -0, 0) has length 0", with("2\n05.png 0 0 1\n03.png 0 -0 0\n"));
    expect_in("dome.LP:3: image '05.png' appears a second time", with("2\n05.png 0 0 1\n05.png 0 1 1\n"));
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

}  // namespace
}  // namespace radiafit

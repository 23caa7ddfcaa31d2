// Readers and writers of capture/: COLMAP models, scaled images, tables. Meshes are in mesh_file_test.cpp, pictures
// in image_file_test.cpp, import as a whole in capture_test.cpp.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <limits>
#include <random>

#include "capture/colmap.h"
#include "capture/gains.h"
#include "capture/image_scale.h"
#include "capture_fixture.h"
#include "dataset/dataset.h"
#include "dataset/split.h"
#include "image/image_file.h"
#include "image/png_file.h"

namespace radiafit {
using namespace tools;
namespace {

using namespace testing;
using Files = testing::FolderTest;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

// ---- COLMAP ----

std::string binary_camera(uint32_t id, int32_t model, const std::vector<double>& parameters) {
    Bytes b;
    b.put(id).put(model).put(uint64_t{64}).put(uint64_t{48});
    for (const double p : parameters) b.put(p);
    return b.text;
}

std::string binary_image(uint32_t id, const std::array<double, 7>& pose, uint32_t camera, const std::string& name,
                         uint64_t points) {
    Bytes b;
    b.put(id);
    for (const double p : pose) b.put(p);
    b.put(camera);
    b.text += name + '\0';
    b.put(points);
    for (uint64_t i = 0; i < points; ++i) b.put(1.5).put(2.5).put(~uint64_t{0});
    return b.text;
}

std::string counted(uint64_t count, const std::string& entries) { return Bytes().put(count).text + entries; }

const std::array<double, 7> pose_a = {1, 1, -1, 1, 0.25, -1.5, 3};
const std::array<double, 7> pose_b = {2, 0, 0, 0, 0, 0, 1};  // not normalized

TEST_F(Files, BinaryModelEqualsTextModel) {
    write_bytes(root_ / "text/cameras.txt",
                "# comment\n\n7 PINHOLE 64 48 60 61.5 32 24.25\r\n2 SIMPLE_PINHOLE 64 48 59.5 31 23\n");
    write_bytes(root_ / "text/images.txt",
                "# comment\n1 2 0 0 0 0 0 1 2 b dir/b one.png\n1.5 2.5 -1 3 4 17\n"
                "5 1 1 -1 1 0.25 -1.5 3 7 a.png\n\n");
    write_bytes(root_ / "bin/cameras.bin",
                counted(2, binary_camera(7, 1, {60, 61.5, 32, 24.25}) + binary_camera(2, 0, {59.5, 31, 23})));
    write_bytes(root_ / "bin/images.bin",
                counted(2, binary_image(1, pose_b, 2, "b dir/b one.png", 2) + binary_image(5, pose_a, 7, "a.png", 0)));
    const Calibration text = read_colmap(root_ / "text"), binary = read_colmap(root_ / "bin");
    ASSERT_EQ(text.images.size(), 2u);
    ASSERT_EQ(binary.images.size(), 2u);
    EXPECT_EQ(text.images[0].name, "a.png");  // sorted
    EXPECT_EQ(text.images[1].name, "b dir/b one.png");
    for (size_t i = 0; i < 2; ++i) {
        const Camera &s = text.images[i].camera, &t = binary.images[i].camera;
        EXPECT_EQ(text.images[i].name, binary.images[i].name);
        EXPECT_EQ(s.width, t.width);
        EXPECT_EQ(s.height, t.height);
        EXPECT_EQ(s.fx, t.fx);
        EXPECT_EQ(s.fy, t.fy);
        EXPECT_EQ(s.cx, t.cx);
        EXPECT_EQ(s.cy, t.cy);
        EXPECT_EQ(s.cam_from_world_rotation, t.cam_from_world_rotation);
        EXPECT_EQ(s.cam_from_world_translation, t.cam_from_world_translation);
    }
    const Camera& a = text.images[0].camera;
    EXPECT_EQ(a.fx, 60);
    EXPECT_EQ(a.fy, 61.5);
    EXPECT_EQ(a.cy, 24.25);
    EXPECT_EQ(text.images[1].camera.fy, 59.5);
    // q = (1, 1, -1, 1)/2 by hand: R = I + 2w[v] + 2[v]^2, whose columns are the images of the axes.
    EXPECT_TRUE(a.cam_from_world_rotation.col(0).isApprox(Vec3d(0, 0, 1), 1e-15)) << a.cam_from_world_rotation;
    EXPECT_TRUE(a.cam_from_world_rotation.col(1).isApprox(Vec3d(-1, 0, 0), 1e-15)) << a.cam_from_world_rotation;
    EXPECT_TRUE(a.cam_from_world_rotation.col(2).isApprox(Vec3d(0, -1, 0), 1e-15)) << a.cam_from_world_rotation;
    EXPECT_EQ(a.cam_from_world_translation, Vec3d(0.25, -1.5, 3));
    EXPECT_EQ(text.images[1].camera.cam_from_world_rotation, Mat3d::Identity());

    // Where both stand in one folder, the binary one is read, as COLMAP does.
    fs::copy(root_ / "text/cameras.txt", root_ / "bin/cameras.txt");
    write_bytes(root_ / "bin/images.txt", "nonsense\n");
    EXPECT_EQ(read_colmap(root_ / "bin").images_file.filename(), "images.bin");
}

TEST_F(Files, CamerasWhoseDistortionIsZeroArePinholes) {
    struct Case {
        const char* text;
        int number;
        std::vector<double> parameters;
    };
    const std::vector<Case> cases = {{"SIMPLE_RADIAL", 2, {60, 31, 25, 0}},
                                     {"RADIAL", 3, {60, 31, 25, 0, -0.0}},
                                     {"OPENCV", 4, {60, 61, 31, 25, 0, 0, 0, 0}},
                                     {"FULL_OPENCV", 6, {60, 61, 31, 25, 0, 0, 0, 0, 0, 0, 0, 0}}};
    for (Case c : cases) {
        SCOPED_TRACE(c.text);
        write_bytes(root_ / "text/images.txt", "1 1 0 0 0 0 0 1 1 a.png\n\n");
        write_bytes(root_ / "bin/images.bin", counted(1, binary_image(1, pose_a, 1, "a.png", 0)));
        const auto write = [&] {
            write_bytes(root_ / "text/cameras.txt",
                        fmt::format("1 {} 64 48 {}\n", c.text, fmt::join(c.parameters, " ")));
            write_bytes(root_ / "bin/cameras.bin", counted(1, binary_camera(1, c.number, c.parameters)));
        };
        write();
        for (const char* folder : {"text", "bin"}) {
            const Camera camera = read_colmap(root_ / folder).images.at(0).camera;
            EXPECT_EQ(camera.fx, 60);
            EXPECT_EQ(camera.fy, c.number < 4 ? 60 : 61);
            EXPECT_EQ(camera.cx, 31);
            EXPECT_EQ(camera.cy, 25);
        }
        c.parameters.back() = 0.5;
        write();
        for (const char* folder : {"text", "bin"})
            expect_in(fmt::format("{} with distortion", c.text), complaint([&] { read_colmap(root_ / folder); }));
    }
}

TEST_F(Files, BadTextModelsNameFileAndLine) {
    const std::string good_camera = "1 PINHOLE 64 48 60 60 32 24\n", good_image = "1 1 0 0 0 0 0 1 1 a.png\n\n";
    struct Case {
        std::string cameras, images, where, what;
    };
    const std::vector<Case> cases = {
        {"1 OPENCV 64 48 60 60 32 24 0 0 0.01 0\n", good_image, "cameras.txt:1", "colmap image_undistorter"},
        {"1 SIMPLE_RADIAL 64 48 60 32 24 1e-9\n", good_image, "cameras.txt:1", "SIMPLE_RADIAL with distortion (1e-09)"},
        {"1 SIMPLE_RADIAL 64 48 60 32 24\n", good_image, "cameras.txt:1", "SIMPLE_RADIAL takes 4 parameters"},
        {"1 OPENCV_FISHEYE 64 48 60 60 32 24 0 0 0 0\n", good_image, "cameras.txt:1",
         "OPENCV_FISHEYE is not a pinhole"},
        {"#\n1 PINHOLE 64 48 60 nan 32 24\n", good_image, "cameras.txt:2", "not finite"},
        {"1 PINHOLE 64 48 60 inf 32 24\n", good_image, "cameras.txt:1", "not finite"},
        {"1 PINHOLE 64 48 60 60 32\n", good_image, "cameras.txt:1", "4 parameters"},
        {"1 PINHOLE 64\n", good_image, "cameras.txt:1", "expected"},
        {"1 PINHOLE 64 0 60 60 32 24\n", good_image, "cameras.txt:1", "size"},
        {"1 PINHOLE 64 48 -60 60 32 24\n", good_image, "cameras.txt:1", "focal"},
        {"x PINHOLE 64 48 60 60 32 24\n", good_image, "cameras.txt:1", "CAMERA_ID"},
        {good_camera + good_camera, good_image, "cameras.txt:2", "twice"},
        {good_camera, "1 0 0 0 0 0 0 1 1 a.png\n\n", "images.txt:1", "zero quaternion"},
        {good_camera, "1 1e200 0 0 0 0 0 1 1 a.png\n\n", "images.txt:1", "far from 1"},
        {good_camera, "1 0.01 0 0 0 0 0 1 1 a.png\n\n", "images.txt:1", "far from 1"},
        {"1 PINHOLE 64 48 1e308 60 32 24\n", good_image, "images.txt:1", "focal lengths"},
        {"1 PINHOLE 64 48 60 60 32 1e99\n", good_image, "images.txt:1", "principal point"},
        {good_camera, "1 1 0 0 0 0 0 1e300 1 a.png\n\n", "images.txt:1", "translation"},
        {good_camera, "1 1 0 0 0 0 nan 1 1 a.png\n\n", "images.txt:1", "TY"},
        {good_camera, "1 1 0 0 0 0 0 1e999 1 a.png\n\n", "images.txt:1", "TZ"},
        {good_camera, good_image + "2 1 0 0 0 0 0 1 9 b.png\n\n", "images.txt:3", "camera 9"},
        {good_camera, "1 1 0 0 0 0 0 1 a.png\n\n", "images.txt:1", "expected"},
        {good_camera, "1 1 0 0 0 0 0 1x 1 a.png\n\n", "images.txt:1", "no number"},
        {good_camera, "1 1 0 0 0 0 0 1 1 a.png\n2 1 0 0 0 0 0 1 1 b.png\n", "images.txt:2", "POINT3D_ID"},
        {good_camera, good_image + good_image, "images.txt", "'a.png' is given twice"},
        {good_camera, "# nothing\n", "images.txt", "no image"},
        {"", good_image, "images.txt:1", "camera 1"},
    };
    for (const Case& c : cases) {
        SCOPED_TRACE(c.cameras + c.images);
        write_bytes(root_ / "cameras.txt", c.cameras);
        write_bytes(root_ / "images.txt", c.images);
        const std::string text = complaint([&] { read_colmap(root_); });
        expect_in(c.where, text);
        expect_in(c.what, text);
    }
    expect_in("no COLMAP model", complaint([&] { read_colmap(root_ / "elsewhere"); }));
}

TEST_F(Files, BadBinaryModelsNameTheFile) {
    const std::string cameras = counted(1, binary_camera(1, 1, {60, 60, 32, 24}));
    const std::string images = counted(2, binary_image(1, pose_a, 1, "a.png", 2) + binary_image(2, pose_b, 1, "b", 1));
    const auto read = [&](const std::string& c, const std::string& i) {
        write_bytes(root_ / "cameras.bin", c);
        write_bytes(root_ / "images.bin", i);
        return read_colmap(root_);
    };
    EXPECT_EQ(read(cameras, images).images.size(), 2u);
    for (size_t size = 0; size < cameras.size(); ++size)
        expect_in("cameras.bin: truncated", complaint([&] { read(cameras.substr(0, size), images); }));
    for (size_t size = 0; size < images.size(); ++size)
        expect_in("images.bin: truncated", complaint([&] { read(cameras, images.substr(0, size)); }));
    expect_in("follow the last entry", complaint([&] { read(cameras, images + "x"); }));
    expect_in("camera model OPENCV", complaint([&] {
                  read(counted(1, binary_camera(1, 4, {60, 60, 32, 24, 0, 0.1, 0, 0})), images);
              }));
    expect_in("image_undistorter", complaint([&] { read(counted(1, binary_camera(1, 99, {})), images); }));
    expect_in("not finite", complaint([&] { read(counted(1, binary_camera(1, 1, {nan, 60, 32, 24})), images); }));
    const auto image_only = [](const std::array<double, 7>& pose, uint32_t camera) {
        return counted(1, binary_image(1, pose, camera, "a.png", 0));
    };
    expect_in("zero quaternion", complaint([&] { read(cameras, image_only({0, 0, 0, 0, 1, 2, 3}, 1)); }));
    expect_in("not finite", complaint([&] { read(cameras, image_only({1, 0, 0, 0, 1, nan, 3}, 1)); }));
    expect_in("camera 8", complaint([&] { read(cameras, image_only(pose_a, 8)); }));
    // A count of points that overflows 64 bits when multiplied is a truncated file, not an endless skip.
    std::string huge = image_only(pose_a, 1);
    huge.replace(huge.size() - 8, 8, Bytes().put(~uint64_t{0} / 3).text);
    expect_in("truncated", complaint([&] { read(cameras, huge); }));
}

// ---- Images ----

TEST_F(Files, WritePngRoundTrip) {
    const auto samples = ramp(size_t(7 * 4 * 3), 255);
    const std::vector<uint8_t> rgb(samples.begin(), samples.end());
    write_png(root_ / "out.png", 7, 4, rgb);
    EXPECT_EQ(read_image(root_ / "out.png").rgb8, rgb);
    EXPECT_EQ(std::distance(fs::directory_iterator(root_), {}), 1);  // no temporary file left
    expect_in("writable", complaint([&] { write_png(root_ / "none" / "out.png", 7, 4, rgb); }));
    write_bytes(root_ / "file", "");
    expect_in("writable", complaint([&] { write_png(root_ / "file" / "out.png", 7, 4, rgb); }));
}

TEST(ImageScale, HalvingIsTheMeanInLinearLight) {
    ImageFile image{4, 2, 8, false, {}, {}, {}, {}};
    const auto samples = ramp(24, 255);
    image.rgb8.assign(samples.begin(), samples.end());
    const ImageFile half = scale_down(image, 2, 1);
    for (size_t x = 0; x < 2; ++x)
        for (size_t c = 0; c < 3; ++c) {
            double sum = 0;
            for (const size_t pixel : {2 * x, 2 * x + 1, 2 * x + 4, 2 * x + 5})
                sum += srgb_decode(image.rgb8[3 * pixel + c] / 255.0);
            EXPECT_EQ(half.rgb8[3 * x + c], std::lround(255 * srgb_encode(sum / 4)));
        }
}

TEST(ImageScale, AnyRatioKeepsTheTotalLightAndItsCentre) {
    // 16-bit linear: the first two moments are those of the old image, up to rounding to 1/65535. A pixel's light is
    // spread over its area, so its centre of mass is the pixel centre and area averaging must keep it to 1/2 new pixel.
    ImageFile image{11, 7, 16, true, {}, {}, {}, {}};
    image.rgb16.assign(size_t(11 * 7 * 3), 0);
    for (size_t c = 0; c < 3; ++c) image.rgb16[(3 * 11 + 6) * 3 + c] = 60000;  // pixel (6, 3)
    const ImageFile out = scale_down(image, 5, 3);
    double sum = 0, x = 0, y = 0;
    for (size_t j = 0; j < 3; ++j)
        for (size_t i = 0; i < 5; ++i) {
            const double v = out.rgb16[(j * 5 + i) * 3];
            sum += v;
            x += v * (double(i) + 0.5) * 11 / 5;
            y += v * (double(j) + 0.5) * 7 / 3;
        }
    EXPECT_NEAR(sum / 15 * 77, 60000, 38.5);  // 15 pixels, each rounded by up to 1/2, times 77/15
    EXPECT_NEAR(x / sum, 6.5, 1.1);
    EXPECT_NEAR(y / sum, 3.5, 1.17);

    std::fill(image.rgb16.begin(), image.rgb16.end(), uint16_t{12345});
    for (const uint16_t v : scale_down(image, 5, 3).rgb16) EXPECT_NEAR(v, 12345, 1);
    EXPECT_EQ(scale_down_mask({255, 255, 0, 0, 255, 0, 0, 0}, 4, 2, 2, 1), (std::vector<uint8_t>{255, 0}));
    EXPECT_EQ(scale_down_mask({255, 255, 0, 0}, 2, 2, 1, 1), (std::vector<uint8_t>{255}));  // half is in
}

// ---- Split and gains ----

TEST_F(Files, HoldoutRules) {
    using Flags = std::vector<uint8_t>;
    const std::vector<std::string> names = {"a", "b", "c d", "e", "f"};
    std::vector<Vec3d> fan;  // a fan of directions, 15 degrees apart
    for (int i = 0; i < 5; ++i) fan.push_back({std::sin(0.26 * (i - 2)), 0, std::cos(0.26 * (i - 2))});
    const auto choose_held_out = [&](const std::vector<std::string>& of, const std::string& rule) {
        return radiafit::choose_held_out(of, {fan.data(), of.size()}, rule);
    };
    EXPECT_EQ(choose_held_out(names, "none"), (Flags{0, 0, 0, 0, 0}));
    EXPECT_EQ(choose_held_out(names, "every:2"), (Flags{1, 0, 1, 0, 1}));
    EXPECT_EQ(choose_held_out(names, "every:8"), (Flags{1, 0, 0, 0, 0}));
    EXPECT_EQ(choose_held_out(names, "every:2+1"), (Flags{0, 1, 0, 1, 0}));
    EXPECT_EQ(choose_held_out(names, "every:3+2"), (Flags{0, 0, 1, 0, 0}));
    EXPECT_EQ(choose_held_out(names, "spread:1"), (Flags{0, 0, 1, 0, 0}));  // the middle one
    const Flags drawn = choose_held_out(names, "random:2");
    EXPECT_EQ(std::count(drawn.begin(), drawn.end(), 1), 2);
    EXPECT_EQ(choose_held_out(names, "random:2:1"), drawn);
    bool another = false;
    for (int seed = 2; seed < 12; ++seed)
        another = another || choose_held_out(names, "random:2:" + std::to_string(seed)) != drawn;
    EXPECT_TRUE(another);
    const std::string list = (root_ / "list.txt").string();
    write_bytes(list, "# held out\nc d\n\nf\n");
    EXPECT_EQ(choose_held_out(names, list), (Flags{0, 0, 1, 0, 1}));
    write_bytes(list, "a\nz\n");
    expect_in("list.txt:2", complaint([&] { choose_held_out(names, list); }));
    write_bytes(list, "a\nb\nc d\ne\nf\n");
    expect_in("leaves none", complaint([&] { choose_held_out(names, list); }));
    for (const char* rule :
         {"every:1", "every:0", "every:x", "every:", "every:8x", "every:-3", "every:4+4", "every:4+", "random:0",
          "random:5", "random:2:", "random:x", "spread:0", "spread:5", "spread:2:1", "nobody"})
        expect_in(rule, complaint([&] { choose_held_out(names, rule); }));
    expect_in("leaves none", complaint([&] { choose_held_out({"a"}, "every:8"); }));
}

TEST_F(Files, GainTables) {
    const fs::path file = root_ / "gains.txt";
    write_bytes(file, "# image  exposure  gain\nb.jpg 0.02 2.5 800 1.5\nother.jpg 7\na.jpg\t0.5\n");
    EXPECT_EQ(read_gains(file, {"a.jpg", "b.jpg"}), (std::vector<double>{0.5, 1.5}));
    expect_in("'c.jpg'", complaint([&] { read_gains(file, {"a.jpg", "c.jpg"}); }));
    for (const char* line : {"c.jpg 0\n", "c.jpg -1\n", "c.jpg nan\n", "c.jpg\n", "c.jpg 1x\n", "a.jpg 2\n"}) {
        write_bytes(file, std::string("# head\na.jpg 1\n") + line);
        expect_in("gains.txt:3", complaint([&] { read_gains(file, {"a.jpg"}); }));
    }
    expect_in("no such gain table", complaint([&] { read_gains(root_ / "none.txt", {}); }));
    std::vector<double> gains = {2, 8, 100};
    normalize_gains(gains, {0, 0, 1});
    EXPECT_NEAR(gains[0], 0.5, 1e-12);  // the geometric mean of 2 and 8 is 4
    EXPECT_NEAR(gains[1], 2, 1e-12);
    EXPECT_NEAR(gains[2], 25, 1e-12);
}

TEST(GainEstimate, FindsKnownGainsOfChannels) {
    std::mt19937 random(9);
    std::normal_distribution<double> normal;
    const size_t views = 8, points = 300;
    std::vector<uint8_t> held_out(views, 0);
    held_out[2] = 1;
    std::vector<std::vector<double>> truth(3, std::vector<double>(views));
    for (auto& channel : truth) {
        for (double& g : channel) g = std::exp(0.3 * normal(random));
        channel[5] *= 4;
        normalize_gains(channel, held_out);
    }
    std::vector<std::vector<GainSample>> samples(views);
    for (uint32_t p = 0; p < points; ++p) {
        std::array<double, 3> brightness;
        for (double& b : brightness) b = normal(random);
        for (size_t v = 0; v < views; ++v) {
            GainSample sample{p, 0};
            double sum = 0;
            for (size_t c = 0; c < 3; ++c) {
                const double log_value = brightness[c] - std::log(truth[c][v]) + 0.02 * normal(random);
                sample.log_channels[c] = float(log_value);
                sum += std::exp(log_value) / 3;
            }
            sample.log_value = float(std::log(sum));
            if (v == 5) sample.log_channels[2] = NAN;  // blue is dark throughout
            samples[v].push_back(sample);
        }
    }
    const ChannelGainEstimate estimate = estimate_channel_gains(samples, held_out);
    EXPECT_TRUE(estimate.guessed.empty());
    for (size_t v = 0; v < views; ++v)
        for (size_t c = 0; c < 3; ++c) {
            if (v == 5 && c == 2) continue;
            // that of view 5 is another than the truth, which all of the channel share the mean with
            const double shared = c == 2 ? estimate.gains[0][2] / truth[2][0] : 1;
            EXPECT_NEAR(estimate.gains[v][c] / truth[c][v] / shared, 1, 0.01) << v << ' ' << c;
        }
    // Where a channel says nothing, the view's gain for all channels stands in, of the same size as the others'.
    const double of_all = estimate_gains(samples, held_out).gains[5];
    EXPECT_NEAR(estimate.gains[5][2] / of_all, 1, 0.5);
}

TEST(GainEstimate, FindsKnownGainsAmongHighlights) {
    // 12 views of 600 points; each sees a third. 15 % of the values are highlights, up to 8 times too bright; the rest
    // has 5 % noise. With some 170 good values per view the gains are known to 0.05 / sqrt(170) = 0.4 %, and a few
    // times that through the chain of shared points; highlights that leaked in would show as 10 % and more.
    std::mt19937 random(5);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> uniform;
    const size_t views = 12, points = 600;
    std::vector<double> truth(views);
    for (double& g : truth) g = std::exp(0.3 * normal(random));
    std::vector<uint8_t> held_out(views, 0);
    held_out[4] = 1;
    normalize_gains(truth, held_out);
    std::vector<std::vector<GainSample>> samples(views);
    for (uint32_t p = 0; p < points; ++p) {
        const double brightness = normal(random);
        for (size_t v = 0; v < views; ++v) {
            if (uniform(random) > 1 / 3.0) continue;
            double log_value = brightness - std::log(truth[v]) + 0.05 * normal(random);
            // Uneven: the first views look into the light.
            if (uniform(random) < (v < 3 ? 0.3 : 0.1)) log_value += std::log(8.0) * uniform(random);
            samples[v].push_back({p, float(log_value)});
        }
    }
    const GainEstimate estimate = estimate_gains(samples, held_out);
    EXPECT_TRUE(estimate.guessed.empty());
    double product = 1;
    for (size_t v = 0; v < views; ++v) {
        EXPECT_NEAR(estimate.gains[v] / truth[v], 1, 0.03) << v;
        if (!held_out[v]) product *= estimate.gains[v];
    }
    EXPECT_NEAR(product, 1, 1e-9);

    // A held-out view has no say in the others' gains.
    for (GainSample& s : samples[4]) s.log_value += 3;
    const GainEstimate again = estimate_gains(samples, held_out);
    for (size_t v = 0; v < views; ++v)
        EXPECT_NEAR(again.gains[v] / estimate.gains[v], v == 4 ? std::exp(-3.0) : 1, 1e-6) << v;

    // Nor can a view that shares nothing be estimated: it is named.
    samples[7].clear();
    EXPECT_EQ(estimate_gains(samples, held_out).guessed, std::vector<size_t>{7});
    EXPECT_EQ(estimate_channel_gains(samples, held_out).guessed, std::vector<size_t>{7});
}

}  // namespace
}  // namespace radiafit

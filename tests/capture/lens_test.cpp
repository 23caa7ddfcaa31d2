// Lenses: formulas, photographs undistorted and scaled, and what imports make of both.
#include "capture/lens.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <random>

#include "capture/colmap.h"
#include "capture/image_scale.h"
#include "capture/import.h"
#include "capture/transforms.h"
#include "capture/undistort.h"
#include "capture_fixture.h"
#include "dataset/dataset.h"

namespace radiafit {
using namespace tools;
namespace {

using namespace testing;
using Json = nlohmann::ordered_json;

struct Model {
    const char* name;
    int number;  // in COLMAP's binary files
    std::vector<double> coefficients;
};

/// Of every model one that widens and one that narrows, as cameras have them.
const std::vector<Model> models = {
    {"SIMPLE_RADIAL", 2, {-0.06}},
    {"SIMPLE_RADIAL", 2, {0.12}},
    {"RADIAL", 3, {-0.3, 0.1}},
    {"RADIAL", 3, {0.058, -0.0805}},
    {"OPENCV", 4, {0.0578, -0.0805, -0.00098, 0.00015}},
    {"OPENCV", 4, {-0.2, 0.05, 0.003, -0.002}},
    {"OPENCV_FISHEYE", 5, {0, 0, 0, 0}},
    {"OPENCV_FISHEYE", 5, {-0.03, 0.01, -0.004, 0.0007}},
    {"FULL_OPENCV", 6, {0.3, 0.1, 0.001, -0.0015, 0.02, 0.4, 0.05, 0.01}},
    {"FOV", 7, {0.9}},
    {"FOV", 7, {1e-5}},
    {"SIMPLE_RADIAL_FISHEYE", 8, {0.05}},
    {"RADIAL_FISHEYE", 9, {-0.05, 0.02}},
    {"THIN_PRISM_FISHEYE", 10, {0.02, -0.01, 0.001, -0.002, 0.003, 0.001, 0.0015, -0.0005}},
};

Lens lens_of(const Model& model) { return colmap_lens(model.name, model.coefficients).value(); }

/// As OpenCV's documentation of calib3d and COLMAP's of its camera models write them, each model by itself.
Vec2d by_formula(const Model& model, double u, double v) {
    const std::vector<double>& k = model.coefficients;
    const std::string name = model.name;
    const double r = std::hypot(u, v), r2 = r * r, r4 = r2 * r2, r6 = r4 * r2;
    const double theta = std::atan(r), t2 = theta * theta;
    if (name == "SIMPLE_RADIAL") return Vec2d(u, v) * (1 + k[0] * r2);
    if (name == "RADIAL") return Vec2d(u, v) * (1 + k[0] * r2 + k[1] * r4);
    if (name == "OPENCV" || name == "FULL_OPENCV") {
        double radial = 1 + k[0] * r2 + k[1] * r4;
        if (name == "FULL_OPENCV") radial = (radial + k[4] * r6) / (1 + k[5] * r2 + k[6] * r4 + k[7] * r6);
        return {u * radial + 2 * k[2] * u * v + k[3] * (r2 + 2 * u * u),
                v * radial + k[2] * (r2 + 2 * v * v) + 2 * k[3] * u * v};
    }
    if (name == "OPENCV_FISHEYE")
        return Vec2d(u, v) *
               (theta / r *
                (1 + k[0] * t2 + k[1] * std::pow(theta, 4) + k[2] * std::pow(theta, 6) + k[3] * std::pow(theta, 8)));
    if (name == "SIMPLE_RADIAL_FISHEYE") return Vec2d(u, v) * (theta / r * (1 + k[0] * t2));
    if (name == "RADIAL_FISHEYE") return Vec2d(u, v) * (theta / r * (1 + k[0] * t2 + k[1] * t2 * t2));
    if (name == "FOV") return Vec2d(u, v) * (std::atan(2 * r * std::tan(k[0] / 2)) / (r * k[0]));
    const double a = u * theta / r, b = v * theta / r;  // THIN_PRISM_FISHEYE
    const double radial = k[0] * t2 + k[1] * t2 * t2 + k[4] * std::pow(theta, 6) + k[5] * std::pow(theta, 8);
    return {a + a * radial + 2 * k[2] * a * b + k[3] * (t2 + 2 * a * a) + k[6] * t2,
            b + b * radial + 2 * k[3] * a * b + k[2] * (t2 + 2 * b * b) + k[7] * t2};
}

TEST(Lens, HasThePublishedFormulasAndTheirDerivativesAndInverse) {
    for (const Model& model : models) {
        const Lens lens = lens_of(model);
        SCOPED_TRACE(lens.name());
        std::mt19937 random(3);
        std::uniform_real_distribution<double> uniform(-0.7, 0.7);
        for (int i = 0; i < 200; ++i) {
            const double scale = i % 4 ? 1 : 1e-5;  // near the axis, too
            const double u = scale * uniform(random), v = scale * uniform(random);
            const DistortedPoint d = lens.distort(u, v);
            ASSERT_TRUE(d.valid);
            const Vec2d expected = by_formula(model, u, v);
            ASSERT_NEAR(d.x, expected.x(), 1e-11 * scale);
            ASSERT_NEAR(d.y, expected.y(), 1e-11 * scale);
            const double h = 1e-6;  // of differences: h^2 times a third derivative, below 1e-10
            const DistortedPoint right = lens.distort(u + h, v), left = lens.distort(u - h, v);
            const DistortedPoint below = lens.distort(u, v + h), above = lens.distort(u, v - h);
            ASSERT_NEAR(d.x_u, (right.x - left.x) / (2 * h), 1e-9);
            ASSERT_NEAR(d.y_u, (right.y - left.y) / (2 * h), 1e-9);
            ASSERT_NEAR(d.x_v, (below.x - above.x) / (2 * h), 1e-9);
            ASSERT_NEAR(d.y_v, (below.y - above.y) / (2 * h), 1e-9);
            const auto back = lens.undistort({d.x, d.y});
            ASSERT_TRUE(back);
            ASSERT_NEAR(back->x(), u, 1e-9 * scale);
            ASSERT_NEAR(back->y(), v, 1e-9 * scale);
        }
        EXPECT_EQ(lens.undistort({0, 0}).value(), Vec2d(0, 0));
    }
    EXPECT_FALSE(colmap_lens("PINHOLE", {}));
    EXPECT_FALSE(colmap_lens("FOV", std::vector<double>{0}));
}

TEST(Lens, EndsWhereItsModelFoldsOver) {
    // r - 0.55 r^3 grows up to r = 1 / sqrt(1.65) = 0.7785, and reaches 0.5190 there.
    const Lens lens = lens_of({"SIMPLE_RADIAL", 2, {-0.55}});
    const double fold = 1 / std::sqrt(1.65), most = fold * (1 - 0.55 * fold * fold);
    EXPECT_TRUE(lens.distort(0, fold - 1e-6).valid);
    EXPECT_FALSE(lens.distort(0, fold + 1e-6).valid);
    EXPECT_FALSE(lens.distort(1.2, 0.9).valid);
    EXPECT_NEAR(lens.undistort({0.99 * most, 0}).value().x(), 0.7140, 5e-4);
    EXPECT_FALSE(lens.undistort({1.001 * most, 0}));
    // A divisor's pole: 1 - 0.5 r^2 is 0 at sqrt(2).
    const Lens pole = lens_of({"FULL_OPENCV", 6, {0, 0, 0, 0, 0, -0.5, 0, 0}});
    EXPECT_TRUE(pole.distort(1.41, 0).valid);
    EXPECT_FALSE(pole.distort(1.42, 0).valid);
    // Beyond 90 degrees a fisheye sees what no pinhole shows.
    const Lens fisheye = lens_of({"OPENCV_FISHEYE", 5, {0, 0, 0, 0}});
    EXPECT_TRUE(fisheye.undistort({1.57, 0}));
    EXPECT_FALSE(fisheye.undistort({1.58, 0}));
}

Camera camera_of(int width, int height, double f) {
    Camera camera;
    camera.width = width, camera.height = height;
    camera.fx = camera.fy = f;
    camera.cx = 0.5 * width, camera.cy = 0.5 * height;
    return camera;
}

TEST(Undistort, ChoosesThePinholeThatColmapChooses) {
    // COLMAP 3.8's image_undistorter makes 161 x 120 pixels of it.
    const Camera pinhole = undistorted_camera(camera_of(160, 120, 150), lens_of({"SIMPLE_RADIAL", 2, {-0.06}}));
    EXPECT_EQ(pinhole.width, 161);
    EXPECT_EQ(pinhole.height, 120);
    EXPECT_EQ(pinhole.fx, 150);
    EXPECT_EQ(pinhole.cx, 80.5);
    EXPECT_EQ(pinhole.cy, 60);
}

ImageFile filled(int width, int height, int bits, const std::function<double(int, int, int)>& value) {
    ImageFile image;
    image.width = width, image.height = height, image.bits = bits;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            for (int c = 0; c < 3; ++c) {
                const double v = value(x, y, c);
                if (bits == 8) image.rgb8.push_back(static_cast<uint8_t>(std::lround(v)));
                if (bits == 16) image.rgb16.push_back(static_cast<uint16_t>(std::lround(v)));
                if (bits == 32) image.rgb32.push_back(static_cast<float>(v));
            }
    return image;
}

TEST(Undistort, LeavesAUniformImageAsItIs) {
    const Camera camera = camera_of(90, 70, 80);
    for (const Model& model : models)
        for (const double scale : {1.0, 0.37})
            for (const int bits : {8, 16, 32}) {
                const Lens lens = lens_of(model);
                Camera pinhole = undistorted_camera(camera, lens);
                pinhole = resized_camera(pinhole, std::max(1, int(scale * pinhole.width)),
                                         std::max(1, int(scale * pinhole.height)));
                const double values[3] = {bits == 32 ? 0.1234567 : 3, bits == 32 ? 7.7 : 77, bits == 32 ? 1e-5 : 255};
                const auto out =
                    undistort(filled(90, 70, bits, [&](int, int, int c) { return values[c]; }), camera, lens, pinhole);
                const size_t count = size_t(pinhole.width) * size_t(pinhole.height);
                for (size_t i = 0; i < 3 * count; ++i) {
                    if (!out.inside.empty() && !out.inside[i / 3]) continue;
                    const double got = bits == 8    ? out.image.rgb8[i]
                                       : bits == 16 ? out.image.rgb16[i]
                                                    : double(out.image.rgb32[i]);
                    ASSERT_EQ(got, bits == 32 ? double(float(values[i % 3])) : values[i % 3]) << lens.name();
                }
            }
}

TEST(Undistort, AveragesLightWhereThePictureShrinks) {
    // Black and white by turns, four pixels to one: half of the light, which sRGB stores as 188.
    const Camera camera = camera_of(64, 64, 80);
    const Lens nearly_none = lens_of({"SIMPLE_RADIAL", 2, {1e-12}});
    const auto chequer = [](int x, int y, int) { return (x + y) % 2 ? 255.0 : 0.0; };
    for (const int size : {16, 8}) {
        const auto out =
            undistort(filled(64, 64, 8, chequer), camera, nearly_none, resized_camera(camera, size, size)).image.rgb8;
        for (const uint8_t v : out) ASSERT_NEAR(v, 188, 1);
    }
    // Masks: where half of the area is, and of another size than the photograph.
    std::vector<uint8_t> mask(32 * 32, 0);
    for (size_t i = 0; i < mask.size(); ++i) mask[i] = i % 32 < 16 ? 255 : 0;
    const auto half = undistort_mask(mask, 32, 32, camera, nearly_none, resized_camera(camera, 16, 16));
    for (size_t i = 0; i < half.size(); ++i) ASSERT_EQ(half[i], i % 16 < 8 ? 255 : 0);
}

TEST(Undistort, MakesLinesStraight) {
    // Soft edges between dark and bright at x / z = -0.32, -0.16, ... in the pinhole's plane, bent by the lens.
    const Camera camera = camera_of(240, 180, 220);
    for (const Model& model : {models[2], models[5], models[7]}) {
        const Lens lens = lens_of(model);
        SCOPED_TRACE(lens.name());
        const auto light = [](double u) { return 0.5 + 0.4 * std::sin(2 * M_PI * u / 0.32); };
        const auto out = undistort(filled(240, 180, 16,
                                          [&](int x, int y, int) {
                                              const auto p = lens.undistort({(x + 0.5 - camera.cx) / camera.fx,
                                                                             (y + 0.5 - camera.cy) / camera.fy});
                                              return p ? 65535 * srgb_encode(light(p->x())) : 0.0;
                                          }),
                                   camera, lens, undistorted_camera(camera, lens));
        const Camera pinhole = undistorted_camera(camera, lens);
        const auto at = [&](int x, int y) {
            return srgb_decode(out.image.rgb16[3 * size_t(y * pinhole.width + x)] / 65535.0) - 0.5;
        };
        size_t edges = 0;
        for (int y = 2; y + 2 < pinhole.height; ++y)
            for (int x = 2; x + 3 < pinhole.width; ++x) {
                const double a = at(x, y), b = at(x + 1, y);
                if ((a > 0) == (b > 0)) continue;
                const double edge = (x + 0.5 + a / (a - b) - pinhole.cx) / pinhole.fx / 0.16;
                ASSERT_NEAR(edge, std::round(edge), 0.05 / 220 / 0.16) << x << ", " << y;  // 0.05 pixels
                ++edges;
            }
        EXPECT_GT(edges, 500u);
    }
}

TEST(LightCoder, RoundsAsTheFormulaDoes) {
    for (const int bits : {8, 16})
        for (const bool linear : {false, true}) {
            const LightCoder& coder = LightCoder::of(bits, linear);
            const double largest = std::exp2(bits) - 1;
            for (int i = 0; i <= int(largest); ++i) {
                const double light = linear ? i / largest : srgb_decode(i / largest);
                ASSERT_EQ(coder.stored(float(light)), i);
            }
            std::mt19937 random(1);
            std::uniform_real_distribution<float> uniform(0, 1);
            for (int i = 0; i < 20000; ++i) {
                const float light = uniform(random);
                const double exact = largest * (linear ? double(light) : srgb_encode(light));
                ASSERT_NEAR(coder.stored(light), exact, 0.5 + 1e-2);  // a float's rounding, of 65535
            }
            EXPECT_EQ(coder.stored(-1.0f), 0);
            EXPECT_EQ(coder.stored(7.0f), int(largest));
        }
}

/// Two cameras beside each other look at a square with a smooth texture, through a lens.
class LensImport : public FolderTest {
protected:
    static constexpr int width = 120, height = 96;
    static constexpr double f = 110;

    LensImport() {
        write_bytes(root_ / "mesh.obj", "v -0.6 -0.5 2\nv 0.7 -0.5 2\nv 0.7 0.5 2\nv -0.6 0.5 2\nf 1 4 3 2\n");
        options_.model = root_ / "sparse";
        options_.images = root_ / "images";
        options_.mesh = root_ / "mesh.obj";
        options_.holdout = "none";
    }

    /// Stored sRGB value, from 0 to 255, of the plane at depth 2.
    static double texture(double x, double y, int c) {
        return 128 + 60 * std::sin(7 * x + c) * std::cos(6 * y - 0.5 * c) + 30 * std::sin(11 * (x - y));
    }
    static Camera camera(int number, int w = width, int h = height) {
        Camera camera = resized_camera(camera_of(width, height, f), w, h);
        camera.cam_from_world_translation.x() = 0.2 * number;
        return camera;
    }
    static std::string name(int number) { return fmt::format("{}.png", number); }
    /// The photograph of a camera through a lens, of w x h pixels. Means of 2 x 2 points of each pixel.
    static std::string photograph(int number, const std::optional<Lens>& lens, int w = width, int h = height) {
        const Camera taken = camera(number, w, h);
        std::vector<uint16_t> pixels;
        for (int y = 0; y < h; ++y)
            for (int x = 0; x < w; ++x) {
                std::array<double, 3> light{};
                for (int k = 0; k < 4; ++k) {
                    const Vec2d at((x + (k % 2 + 0.5) / 2 - taken.cx) / taken.fx,
                                   (y + (k / 2 + 0.5) / 2 - taken.cy) / taken.fy);
                    const auto p = lens ? lens->undistort(at) : at;
                    for (int c = 0; p && c < 3; ++c)
                        light[size_t(c)] += srgb_decode(texture(2 * p->x() - 0.2 * number, 2 * p->y(), c) / 255) / 4;
                }
                for (const double mean : light) pixels.push_back(uint16_t(std::lround(255 * srgb_encode(mean))));
            }
        return encode_png(w, h, 3, 8, pixels);
    }
    void write_photographs(const std::optional<Lens>& lens, const std::string& folder = "images", int w = width,
                           int h = height) {
        for (const int i : {0, 1}) write_bytes(root_ / folder / name(i), photograph(i, lens, w, h));
    }
    void write_colmap(const Model& model) {
        std::vector<double> parameters = {f, f, 0.5 * width, 0.5 * height};
        const std::string_view n = model.name;
        if (n.find("RADIAL") != std::string_view::npos) parameters.erase(parameters.begin());
        parameters.insert(parameters.end(), model.coefficients.begin(), model.coefficients.end());
        write_bytes(root_ / "sparse/cameras.txt",
                    fmt::format("1 {} {} {} {}\n", model.name, width, height, fmt::join(parameters, " ")));
        std::string images;
        for (const int i : {0, 1}) images += fmt::format("{} 1 0 0 0 {} 0 0 1 {}\n\n", i + 1, 0.2 * i, name(i));
        write_bytes(root_ / "sparse/images.txt", images);
        write_bytes(root_ / "sparse/points3D.txt", "");
    }
    Json transforms() const {
        Json json = {{"fl_x", f}, {"fl_y", f}, {"w", width}, {"h", height}, {"frames", Json::array()}};
        for (const int i : {0, 1}) {
            const Json matrix = {{1, 0, 0, -0.2 * i}, {0, -1, 0, 0}, {0, 0, -1, 0}, {0, 0, 0, 1}};
            json["frames"].push_back({{"file_path", name(i)}, {"transform_matrix", matrix}});
        }
        return json;
    }
    Dataset import(ImportReport (*importer)(const ImportOptions&, const fs::path&) = import_colmap) {
        fs::remove_all(root_ / "set");
        report_ = importer(options_, root_ / "set");
        return open_dataset(root_ / "set");
    }
    Dataset import_json(const Json& json) {
        write_bytes(root_ / "transforms.json", json.dump());
        options_.model = root_ / "transforms.json";
        return import(import_transforms);
    }
    std::string refused() {
        const std::string text = complaint([&] { import_colmap(options_, root_ / "set"); });
        EXPECT_FALSE(fs::exists(root_ / "set"));
        return text;
    }
    /// Mean difference of the dataset's pixels from the texture, in stored values, where the square is seen.
    double error(const Dataset& set) const {
        const std::string bytes = read_bytes(set.folder / "images.bin");
        double sum = 0;
        size_t count = 0;
        for (const View& view : set.views) {
            const Camera& c = view.camera;
            for (int y = 0; y < c.height; ++y)
                for (int x = 0; x < c.width; ++x) {
                    const Vec3d world = c.center() + 2 * Vec3d((x + 0.5 - c.cx) / c.fx, (y + 0.5 - c.cy) / c.fy, 1);
                    if (world.x() < -0.6 || world.x() > 0.7 || std::abs(world.y()) > 0.5) continue;
                    for (int k = 0; k < 3; ++k, ++count)
                        sum += std::abs(texture(world.x(), world.y(), k) -
                                        uint8_t(bytes[view.pixel_offset + 3 * size_t(y * c.width + x) + size_t(k)]));
                }
        }
        return count ? sum / double(count) : 1e9;
    }
    bool remarks_have(const std::string& part) const {
        return std::any_of(report_.remarks.begin(), report_.remarks.end(),
                           [&](const std::string& r) { return r.find(part) != std::string::npos; });
    }

    ImportOptions options_;
    ImportReport report_;
};

// Rounding to whole values leaves 0.25 in the mean; bilinear look-ups and the means over pixels add some tenths.
constexpr double largest_error = 0.9;

TEST_F(LensImport, EveryModelShowsWhatAPinholeWould) {
    for (const Model& model : models) {
        const Lens lens = lens_of(model);
        SCOPED_TRACE(lens.name());
        write_photographs(lens);
        write_colmap(model);
        const Dataset set = import();
        EXPECT_LT(error(set), largest_error);
        EXPECT_TRUE(remarks_have(fmt::format("undistorted from {} (", model.name)));
        expect_in("undistorted from", set.description);
        options_.max_size = 50;  // in the same step
        EXPECT_LT(error(import()), 2.5);
        options_.max_size = 0;
        // What has no use for lenses refuses them by name.
        expect_in(model.name, complaint([&] { read_colmap(root_ / "sparse"); }));
    }
}

TEST_F(LensImport, ReadsTheCoefficientsOfTransforms) {
    options_.images = root_ / "images";
    const auto expect = [&](const Model& model, const Json& fields) {
        SCOPED_TRACE(fields.dump());
        write_photographs(lens_of(model));
        Json json = transforms();
        json.update(fields);
        EXPECT_LT(error(import_json(json)), largest_error);
        EXPECT_TRUE(remarks_have("undistorted from"));
    };
    expect(models[4], {{"k1", 0.0578}, {"k2", -0.0805}, {"p1", -0.00098}, {"p2", 0.00015}});
    expect(models[5], {{"k1", -0.2}, {"k2", 0.05}, {"p1", 0.003}, {"p2", -0.002}, {"k3", 0}, {"is_fisheye", false}});
    expect(models[2], {{"camera_model", "OPENCV"}, {"distortion_params", {-0.3, 0.1, 0, 0, 0, 0}}});
    expect(models[7],
           {{"camera_model", "OPENCV_FISHEYE"}, {"k1", -0.03}, {"k2", 0.01}, {"k3", -0.004}, {"k4", 0.0007}});
    expect(models[6], {{"is_fisheye", true}});
    expect(models[8], {{"camera_model", "FULL_OPENCV"},
                       {"k1", 0.3},
                       {"k2", 0.1},
                       {"p1", 0.001},
                       {"p2", -0.0015},
                       {"k3", 0.02},
                       {"k4", 0.4},
                       {"k5", 0.05},
                       {"k6", 0.01}});
    // Each frame may have its own.
    Json json = transforms();
    json["k1"] = 0.12;
    json["frames"][1]["k1"] = -0.06;
    write_bytes(root_ / "images/0.png", photograph(0, lens_of(models[1])));
    write_bytes(root_ / "images/1.png", photograph(1, lens_of(models[0])));
    EXPECT_LT(error(import_json(json)), largest_error);
    EXPECT_TRUE(remarks_have("2 lenses, of which this is the first"));
    // k4 alone is the eighth power's, with k5 or k6 a divisor's.
    const auto at = [&](const Json& fields) {
        Json changed = transforms();
        changed.update(fields);
        write_bytes(root_ / "transforms.json", changed.dump());
        const auto lens = read_transforms(find_transforms(root_ / "transforms.json"), options_.images).images[0].lens;
        return lens.value().distort(0.5, 0).x;
    };
    EXPECT_NEAR(at({{"k4", 0.2}}), 0.5 * (1 + 0.2 * std::pow(0.5, 8)), 1e-15);
    EXPECT_NEAR(at({{"k4", 0.2}, {"k6", 0.1}}), 0.5 / (1 + 0.2 * 0.25 + 0.1 * std::pow(0.5, 6)), 1e-15);
}

TEST_F(LensImport, ScalesIntrinsicsWithThePhotographs) {
    // Halves, thirds, and odd sizes rounded, with and without a lens; for every kind of calibration.
    for (const auto& [w, h] : {std::pair(60, 48), std::pair(40, 32), std::pair(79, 64), std::pair(240, 192)}) {
        SCOPED_TRACE(fmt::format("{} x {}", w, h));
        write_photographs({}, "images", w, h);
        options_.model = root_ / "sparse";
        write_colmap({"PINHOLE", 1, {}});
        Dataset set = import();
        EXPECT_LT(error(set), w < 60 ? 4 : 2);
        EXPECT_TRUE(remarks_have(fmt::format("0.png: {} x {} pixels, where", w, h)));
        EXPECT_EQ(set.views[0].full_size, (std::array<int, 2>{w, h}));
        EXPECT_LT(error(import_json(transforms())), w < 60 ? 4 : 2);
    }
    const Lens lens = lens_of(models[2]);
    write_photographs(lens, "images", width / 2, height / 2);
    options_.model = root_ / "sparse";
    write_colmap(models[2]);
    // Masks of either size.
    options_.masks = root_ / "masks";
    for (const int scale : {1, 2}) {
        std::vector<uint16_t> mask(size_t(width / scale * height / scale), 0);
        for (size_t i = 0; i < mask.size(); ++i) mask[i] = int(i) % (width / scale) < width / scale / 2 ? 255 : 0;
        for (const int i : {0, 1})
            write_bytes(options_.masks / name(i), encode_png(width / scale, height / scale, 1, 8, mask));
        const Dataset set = import();
        EXPECT_LT(error(set), 2);
        EXPECT_NEAR(set.views[0].camera.width, 25, 1);  // from the square's left side, 13.5, to 30; and twice four
    }
}

TEST_F(LensImport, RefusesSizesThatAreNoScale) {
    write_photographs({});
    write_colmap({"PINHOLE", 1, {}});
    write_bytes(root_ / "images/1.png", photograph(1, {}, 60, 48));
    expect_in("images/1.png: 60 x 48 pixels, but", refused());
    write_bytes(root_ / "images/0.png", photograph(0, {}, 60, 48));
    write_bytes(root_ / "images/1.png", photograph(1, {}, 40, 32));
    const std::string text = refused();
    expect_in("images/1.png: 40 x 32 pixels, but", text);
    expect_in("images/0.png, of the same camera, has 60 x 48", text);
    for (const auto& [w, h] : {std::pair(60, 50), std::pair(118, 94), std::pair(100, 96)}) {
        write_bytes(root_ / "images/0.png", photograph(0, {}, w, h));
        expect_in(fmt::format("images/0.png: {} x {} pixels, but", w, h), refused());
    }
}

TEST_F(LensImport, LeavesOutWhatTheModelFoldsOver) {
    // At the corners of 120 x 96 pixels the radius is 0.698, and this model shows no more than 0.519.
    const Model model = {"SIMPLE_RADIAL", 2, {-0.55}};
    write_photographs(lens_of(model));
    write_colmap(model);
    EXPECT_LT(error(import()), largest_error);
    EXPECT_TRUE(remarks_have("% of the photograph, at its border, is beyond what lens SIMPLE_RADIAL (-0.55)"));
    write_colmap({"SIMPLE_RADIAL", 2, {-400}});
    fs::remove_all(root_ / "set");
    const std::string text = refused();
    expect_in("lens SIMPLE_RADIAL (-400) of image '0.png' folds the picture over", text);
    expect_in("cameras.txt", text);
}

TEST_F(LensImport, AgreesWithColmapsOwnUndistorter) {
    if (std::system("colmap help > /dev/null 2>&1") != 0) GTEST_SKIP() << "colmap is not installed";
    for (const Model& model : {models[0], models[4], models[7], models[8]}) {
        const Lens lens = lens_of(model);
        SCOPED_TRACE(lens.name());
        write_photographs(lens);
        write_colmap(model);
        fs::remove_all(root_ / "flat");
        const std::string command = fmt::format(
            "colmap image_undistorter --image_path {0}/images --input_path {0}/sparse --output_path {0}/flat > {0}/log "
            "2>&1 "
            "&& colmap model_converter --input_path {0}/flat/sparse --output_path {0}/flat/sparse --output_type TXT >> "
            "{0}/log 2>&1",
            root_.string());
        ASSERT_EQ(std::system(command.c_str()), 0) << read_bytes(root_ / "log");
        const Camera theirs = read_colmap(root_ / "flat/sparse").images.at(0).camera;
        const Camera taken = camera(0), ours = undistorted_camera(taken, lens);
        EXPECT_EQ(ours.width, theirs.width);
        EXPECT_EQ(ours.height, theirs.height);
        EXPECT_NEAR(ours.fx, theirs.fx, 1e-9);
        EXPECT_NEAR(ours.cx, theirs.cx, 1e-9);
        EXPECT_NEAR(ours.cy, theirs.cy, 1e-9);
        const ImageFile flat = read_image(root_ / "flat/images/0.png");
        const ImageFile mine = undistort(read_image(root_ / "images/0.png"), taken, lens, theirs).image;
        ASSERT_EQ(flat.rgb8.size(), mine.rgb8.size());
        double sum = 0;
        for (size_t i = 0; i < flat.rgb8.size(); ++i) sum += std::abs(int(flat.rgb8[i]) - int(mine.rgb8[i]));
        EXPECT_LT(sum / double(flat.rgb8.size()), 0.5);
    }
}

}  // namespace
}  // namespace radiafit

// `--gains auto`: whether it tells exposures that changed from gloss, on twelve captures whose light is known.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <vector>

#include "base/parallel.h"
#include "base/rng.h"
#include "capture/import.h"
#include "capture_fixture.h"
#include "dataset/dataset.h"
#include "geometry/raster.h"
#include "mesh_shapes.h"

namespace radiafit {
using namespace tools;
namespace {

using namespace testing;

enum class Shape { star, board };
enum class Gloss { none, broad, sharp };
enum class Exposure { fixed, steps };

struct MadeCapture {
    Shape shape;
    Gloss gloss;
    Exposure exposure;
};

std::string name_of(const MadeCapture& c) {
    constexpr const char *shapes[] = {"star", "board"}, *glosses[] = {"matte", "broad", "sharp"},
                         *exposures[] = {"fixed", "steps"};
    return fmt::format("{}_{}_{}", shapes[int(c.shape)], glosses[int(c.gloss)], exposures[int(c.exposure)]);
}

/// A board in relief, facing +z.
Mesh board() {
    Mesh mesh;
    constexpr int side = 24;
    for (int y = 0; y <= side; ++y)
        for (int x = 0; x <= side; ++x) {
            const float u = 2 * float(x) / side - 1, v = 2 * float(y) / side - 1;
            mesh.positions.push_back({u, v, 0.05f * std::sin(7 * u) * std::cos(6 * v)});
        }
    for (uint32_t y = 0; y < side; ++y)
        for (uint32_t x = 0; x < side; ++x) {
            const uint32_t a = y * (side + 1) + x, b = a + side + 1;
            mesh.triangles.push_back({a, a + 1, b});
            mesh.triangles.push_back({a + 1, b + 1, b});
        }
    return mesh;
}

class GainsAuto : public FolderTest, public ::testing::WithParamInterface<MadeCapture> {
protected:
    static constexpr int views = 20, width = 240, height = 180;

    GainsAuto() : mesh_(GetParam().shape == Shape::star ? ball(12, 0.15f) : board()) {
        Rng rng(11);
        for (int i = 0; i < views; ++i) {
            exposures_.push_back(1);
            if (GetParam().exposure == Exposure::steps) exposures_.back() = std::exp2((int(rng.index(5)) - 2) / 3.0);
        }
    }

    /// Around the star in two heights, 36 degrees apart; before the board on an arc of 90 degrees.
    Camera camera(int i) const {
        const bool around = GetParam().shape == Shape::star;
        const double angle = (around ? 18.0 * i : 90.0 * i / (views - 1) - 45) * std::numbers::pi / 180;
        const Vec3d eye(4 * std::sin(angle), i % 2 ? 1.5 : 0.3, 4 * std::cos(angle));
        return Camera::look_at(eye, Vec3d::Zero(), Vec3d::UnitY(), 0.6, width, height);
    }

    /// Light that leaves a point, by channel: a pattern under a lamp and the sky, and gloss of the lamp's colour.
    Vec3d light(const Vec3d& p, const Vec3d& normal, const Vec3d& to_eye) const {
        static const Vec3d lamp = Vec3d(0.4, 0.7, 0.6).normalized();
        const double pattern = 0.5 + 0.3 * std::sin(9 * p.x() + 2) * std::cos(8 * p.y() - 1) * std::cos(7 * p.z());
        const Vec3d albedo(0.5 * pattern, 0.4 * pattern * pattern + 0.1, 0.3 * pattern + 0.05);
        const double facing = std::max(0.0, normal.dot(lamp));
        const Gloss gloss = GetParam().gloss;
        const double exponent = gloss == Gloss::broad ? 8 : 60;
        const double lobe = std::pow(std::max(0.0, normal.dot((lamp + to_eye).normalized())), exponent);
        return albedo * (0.15 + 0.5 * facing) + Vec3d::Constant(gloss == Gloss::none || facing == 0 ? 0 : 0.35 * lobe);
    }

    std::string photograph(int i, const Camera& camera) const {
        Rasterizer raster;
        raster.draw(mesh_, camera);
        std::vector<uint16_t> pixels;
        uint64_t count = 0;
        for (const RasterPixel& pixel : raster.pixels()) {
            Vec3d value = Vec3d::Zero();
            if (pixel.triangle != no_triangle) {
                const auto& t = mesh_.triangles[pixel.triangle];
                const Vec3d a = mesh_.positions[t[0]].cast<double>(), b = mesh_.positions[t[1]].cast<double>(),
                            c = mesh_.positions[t[2]].cast<double>();
                const Vec3d p = a + double(pixel.b1) * (b - a) + double(pixel.b2) * (c - a);
                value = light(p, (b - a).cross(c - a).normalized(), (camera.center() - p).normalized());
            }
            for (int channel = 0; channel < 3; ++channel) {
                const double noise = 0.01 * (random_uniform(uint64_t(i), count++) - 0.5);
                const double stored = srgb_encode(std::clamp(exposures_[size_t(i)] * value[channel], 0.0, 1.0)) + noise;
                pixels.push_back(uint16_t(std::lround(255 * std::clamp(stored, 0.0, 1.0))));
            }
        }
        return encode_png(width, height, 3, 8, pixels);
    }

    void write_capture() const {
        std::string cameras, images, obj;
        for (const Vec3f& p : mesh_.positions) obj += fmt::format("v {} {} {}\n", p.x(), p.y(), p.z());
        for (const auto& t : mesh_.triangles) obj += fmt::format("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
        write_bytes(root_ / "mesh.obj", obj);
        std::vector<std::string> pngs(views);
        parallel_for(views, 1, [&](size_t i, int) { pngs[i] = photograph(int(i), camera(int(i))); });
        for (int i = 0; i < views; ++i) {
            const Camera c = camera(i);
            const Eigen::Quaterniond q(c.cam_from_world_rotation);
            const Vec3d& t = c.cam_from_world_translation;
            const std::string name = fmt::format("{:02}.png", i);
            cameras += fmt::format("{} PINHOLE {} {} {} {} {} {}\n", i + 1, width, height, c.fx, c.fy, c.cx, c.cy);
            images += fmt::format("{} {} {} {} {} {} {} {} {} {}\n\n", i + 1, q.w(), q.x(), q.y(), q.z(), t.x(), t.y(),
                                  t.z(), i + 1, name);
            write_bytes(root_ / "images" / name, pngs[size_t(i)]);
        }
        write_bytes(root_ / "sparse/cameras.txt", cameras);
        write_bytes(root_ / "sparse/images.txt", images);
    }

    Mesh mesh_;
    std::vector<double> exposures_;
};

TEST_P(GainsAuto, AreAppliedWhereExposuresChanged) {
    write_capture();
    ImportOptions options;
    options.model = root_ / "sparse";
    options.images = root_ / "images";
    options.mesh = root_ / "mesh.obj";
    options.holdout = "every:8";
    ASSERT_EQ(options.gains, "auto");
    const ImportReport report = import_colmap(options, root_ / "set");
    const Dataset set = open_dataset(root_ / "set");
    const bool changed = GetParam().exposure != Exposure::fixed;
    std::string said;
    for (const std::string& remark : report.remarks)
        if (remark.starts_with("gains are ")) said += remark;
    RecordProperty("said", said);
    EXPECT_TRUE(
        said.starts_with(changed ? "gains are needed, and applied" : "gains are not needed, and none are applied"))
        << said;
    bool applied = false;
    for (const View& view : set.views) applied |= view.gain != 1;
    EXPECT_EQ(applied, changed);
}

std::vector<MadeCapture> made_captures() {
    std::vector<MadeCapture> all;
    for (const Shape shape : {Shape::star, Shape::board})
        for (const Gloss gloss : {Gloss::none, Gloss::broad, Gloss::sharp})
            for (const Exposure exposure : {Exposure::fixed, Exposure::steps}) all.push_back({shape, gloss, exposure});
    return all;
}

INSTANTIATE_TEST_SUITE_P(Made, GainsAuto, ::testing::ValuesIn(made_captures()),
                         [](const auto& made) { return name_of(made.param); });

}  // namespace
}  // namespace radiafit

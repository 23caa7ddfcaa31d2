// Errors by the angle to the nearest training image, of scenes whose angles are known.
#include "eval/nearest_training.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "eval/judge.h"
#include "square_scene.h"
#include "temporary_folder.h"

namespace radiafit::testing {
namespace {

constexpr int size = square_size;

/// 26 dB off the left half, 20 dB off the right one (of what is known to be 128 / 255).
const Contestant two_halves{[](const View&, const std::vector<RasterPixel>& pixels, std::vector<float>& rgb, int) {
                                rgb.assign(3 * pixels.size(), 128 / 255.0f);
                                for (size_t i = 0; i < rgb.size(); ++i)
                                    rgb[i] += pixels[i / 3].triangle < 2 ? 0.05f : 0.1f;
                            },
                            TargetSpace::stored};

JudgeResult judged(const Dataset& dataset) {
    JudgeOptions options;
    options.by_angle = true;
    options.pixel_points = 1;
    return judge(two_halves, dataset, Split::test, options);
}

uint64_t binned(const ErrorsByAngle& errors) {
    uint64_t values = errors.unseen.values;
    for (const ErrorSums& bin : errors.bins) values += bin.values;
    return values;
}

TEST(NearestTraining, FarCamerasHaveOneAngleEverywhere) {
    const TemporaryFolder folder;
    const double far = 1e4;
    const JudgeResult result = judged(write_square(
        folder.path() / "d", {{far * tilted(0), false}, {far * tilted(20), false}, {far * tilted(8), true}}));
    ASSERT_GT(result.stored.values, 1000u);
    EXPECT_EQ(result.by_angle.bins[2].values, result.stored.values) << "8 degrees: from 6 to 10";
    EXPECT_EQ(binned(result.by_angle), result.stored.values);
    EXPECT_NEAR(result.by_angle.bins[2].psnr(), result.psnr(), 1e-12);
}

TEST(NearestTraining, OnlyImagesThatSeeTheSurfaceCount) {
    const TemporaryFolder folder;
    const double far = 1e4;
    const auto right = [](int x) { return x >= size / 2; };
    // Seen from 2 degrees on the right alone, from 18 degrees everywhere; from behind it isn't seen.
    const JudgeResult result = judged(write_square(folder.path() / "d", {{far * tilted(0), false},
                                                                         {far * tilted(20), false, right},
                                                                         {far * tilted(162), false},
                                                                         {far * tilted(18), true}}));
    EXPECT_EQ(binned(result.by_angle), result.stored.values);
    EXPECT_NEAR(result.by_angle.bins[0].psnr(), 20, 1e-4);
    EXPECT_NEAR(result.by_angle.bins[4].psnr(), -20 * std::log10(0.05), 1e-4);
    EXPECT_NEAR(double(result.by_angle.bins[0].values), 0.5 * double(result.stored.values), 3.0 * size)
        << "to a column of pixels";
    EXPECT_EQ(result.by_angle.bins[0].values + result.by_angle.bins[4].values, result.stored.values);

    const JudgeResult half =
        judged(write_square(folder.path() / "half", {{far * tilted(20), false, right}, {far * tilted(18), true}}));
    EXPECT_NEAR(half.by_angle.unseen.psnr(), -20 * std::log10(0.05), 1e-4);
    EXPECT_EQ(half.by_angle.unseen.values, result.by_angle.bins[4].values);
    const auto json = nlohmann::json::parse(judge_json(half));
    EXPECT_EQ(json.at("unseen").at("pixels"), half.by_angle.unseen.values / 3);
    EXPECT_EQ(json.at("by_angle").size(), 7u);
    EXPECT_EQ(json.at("by_angle").at(0).at("degrees"), (std::vector<double>{0, 3}));
    EXPECT_EQ(json.at("by_angle").at(6).at("degrees"), (std::vector<double>{30, 180}));
    EXPECT_NEAR(json.at("by_angle").at(0).at("share").get<double>() + json.at("unseen").at("share").get<double>(), 1,
                1e-12);
    EXPECT_TRUE(json.at("by_angle").at(1).at("psnr").is_null());
}

TEST(NearestTraining, NearCamerasHaveAnAngleForEachPixel) {
    const TemporaryFolder folder;
    const Vec3d eye(0.3, -0.2, 2.5), one(-1.2, 0.5, 2), two(0.8, 0.9, 2.5);
    const Dataset dataset = write_square(folder.path() / "d", {{one, false}, {two, false}, {eye, true}});
    const NearestTraining nearest(dataset, ImageStream(dataset, StreamSource::disk));
    Rasterizer rasterizer;
    const Camera& camera = dataset.views[2].camera;
    rasterizer.draw(dataset.mesh, camera);
    double least = 10, most = 0;
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) {
            const RasterPixel& pixel = rasterizer.pixels()[size_t(y * size + x)];
            if (pixel.triangle == no_triangle) continue;
            // Where the ray through the pixel's centre meets the plane z = 0.
            const Vec3d ray = camera.cam_from_world_rotation.transpose() *
                              Vec3d((x + 0.5 - camera.cx) / camera.fx, (y + 0.5 - camera.cy) / camera.fy, 1);
            const Vec3d point = eye - eye.z() / ray.z() * ray;
            const auto to = [&](const Vec3d& other) {
                return std::acos((eye - point).normalized().dot((other - point).normalized()));
            };
            const double expected = std::min(to(one), to(two));
            ASSERT_NEAR(nearest.angle(dataset.views[2], pixel), expected, 1e-5) << x << ", " << y;
            least = std::min(least, expected), most = std::max(most, expected);
        }
    EXPECT_GT(most - least, 5 * degree) << "or the centre alone would do";
}

TEST(NearestTraining, ALampIsAsFarAsACamera) {
    const TemporaryFolder folder;
    const auto shot = [](double camera, double lamp, bool held_out) {
        return Shot{Vec3d::Zero(), held_out, [](int) { return true; }, tilted(lamp), tilted(camera)};
    };
    const auto bin_of = [&](const char* name, const std::vector<Shot>& shots) {
        const JudgeResult result = judged(write_square(folder.path() / name, shots, true));
        for (size_t i = 0; i < result.by_angle.bins.size(); ++i)
            if (result.by_angle.bins[i].values == result.stored.values) return int(i);
        return -1;
    };
    // The camera stands still: the lamp's angle, 12 degrees.
    EXPECT_EQ(bin_of("lamps", {shot(0, -20, false), shot(0, 32, false), shot(0, 20, true)}), 3);
    // Of each image the larger angle, 25 and 8 degrees: not the nearest lamp (1) and the nearest camera (2) apart.
    EXPECT_EQ(bin_of("both", {shot(25, 11, false), shot(2, 18, false), shot(0, 10, true)}), 2);
    EXPECT_EQ(bin_of("beyond", {shot(0, -21, false), shot(0, 10, true)}), 6);
}

TEST(NearestTraining, NothingOfTrainingViews) {
    const TemporaryFolder folder;
    const Dataset dataset = write_square(folder.path() / "d", {{10 * tilted(0), false}, {10 * tilted(8), true}});
    JudgeOptions options;
    options.by_angle = true;
    EXPECT_FALSE(judge(two_halves, dataset, Split::train, options).by_angle.any());
    EXPECT_FALSE(judge(two_halves, dataset, Split::test).by_angle.any()) << "unless it was asked for";
    EXPECT_FALSE(nlohmann::json::parse(judge_json(judge(two_halves, dataset, Split::test))).contains("by_angle"));
}

}  // namespace
}  // namespace radiafit::testing

// Fits by view direction off their photographs, on a square whose cameras' directions are known.
#include "eval/safe_views.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "square_scene.h"
#include "temporary_folder.h"

namespace radiafit::testing {
namespace {

constexpr double distance = 1e4;  // so that all places see a camera in one direction

View seen_from(double degrees) {
    View view;
    view.camera = Camera::look_at(distance * tilted(degrees), Vec3d::Zero(), Vec3d::UnitY(), 2.1 / distance,
                                  square_size, square_size);
    return view;
}

double tilt_of(const View& view) {
    const Vec3d eye = view.camera.center();
    return std::atan2(eye.x(), eye.z()) / degree;
}

/// As polynomials are: tame up to 20 degrees, and 1.6 at 30, 32 at 60.
float runaway(double degrees) { return 0.4f + 0.1f * float(std::pow(degrees / 20, 6)); }

const Contestant runaway_fit{[](const View& view, const std::vector<RasterPixel>& pixels, std::vector<float>& rgb,
                                int) { rgb.assign(3 * pixels.size(), runaway(tilt_of(view))); },
                             TargetSpace::stored};

class SafeViewsOfASquare : public ::testing::Test {
protected:
    void photograph(const std::vector<Shot>& shots) {
        dataset = write_square(folder.path() / "d", shots);
        const auto atlas = std::make_shared<const TriangleAtlas>(dataset.mesh, 4);
        bounds =
            std::make_shared<const SafeViews>(dataset, dataset.split(false), atlas, SurfaceLookup::linear, runaway_fit);
        shown = safe_contestant_of(bounds, runaway_fit);
    }
    float at(double degrees, const RasterPixel& pixel = {0, 0.25f, 0.25f}) const {
        std::vector<float> rgb;
        shown.shade(seen_from(degrees), {pixel}, rgb, 0);
        return rgb[0];
    }

    TemporaryFolder folder;
    Dataset dataset;
    std::shared_ptr<const SafeViews> bounds;
    Contestant shown;
};

std::vector<Shot> fan() {
    std::vector<Shot> shots;
    for (const double degrees : {-16, -8, 0, 8, 16}) shots.push_back({distance * tilted(degrees), false});
    return shots;
}

TEST_F(SafeViewsOfASquare, NearPhotographsAreTheFit) {
    photograph(fan());
    for (const double degrees : {-23.0, -16.0, -12.0, 0.0, 5.0, 16.0, 23.0}) {
        EXPECT_EQ(at(degrees), runaway(degrees)) << degrees;
        EXPECT_EQ(shown.share_of_fit(seen_from(degrees)), 1) << degrees;
    }
}

TEST_F(SafeViewsOfASquare, FarOffIsTheMean) {
    photograph(fan());
    float sum = 0, weights = 0;
    for (const double degrees : {-16, -8, 0, 8, 16}) {
        const auto weight = float(std::cos(degrees * degree));
        sum += weight * runaway(degrees), weights += weight;
    }
    for (const double degrees : {-80.0, 75.5, 85.0}) {
        EXPECT_NEAR(at(degrees), sum / weights, 1e-5) << degrees;
        EXPECT_NEAR(shown.share_of_fit(seen_from(degrees)), 0, 1e-3) << degrees;
    }
}

TEST_F(SafeViewsOfASquare, InBetweenIsContinuousAndBounded) {
    photograph(fan());
    const float mean = at(80), reach = runaway(16) - mean;
    const double step = 0.05;
    float before = at(16);
    for (double degrees = 16 + step; degrees < 85; degrees += step) {
        const float here = at(degrees);
        EXPECT_NEAR(here, before, 0.05) << degrees;
        if (degrees > 35) {
            EXPECT_LE(here, mean + SafeViews::most * reach + 1e-5) << degrees;
        }
        before = here;
    }
}

TEST_F(SafeViewsOfASquare, OnlyPhotographsThatShowAPlaceCount) {
    photograph({{distance * tilted(-20), false},
                {distance * tilted(30), false, [](int x) { return x >= 3 * square_size / 4; }}});
    EXPECT_EQ(at(30, {3, 0.5f, 0.25f}), runaway(30)) << "the right half's photograph";
    EXPECT_LT(at(30, {1, 0, 0.99f}), runaway(30)) << "the left edge is 50 degrees from its only one";
    EXPECT_GT(at(30, {1, 0.99f, 0}), at(30, {1, 0.5f, 0.49f})) << "and the middle shares the right half's";
}

TEST_F(SafeViewsOfASquare, PhotographsThatAreFarApartReachFarther) {
    photograph({{distance * tilted(-30), false}, {distance * tilted(0), false}, {distance * tilted(30), false}});
    EXPECT_EQ(at(15), runaway(15)) << "half way between two";
    EXPECT_EQ(at(45), runaway(45)) << "as far beyond them";
    EXPECT_NE(at(80), runaway(80));
}

TEST_F(SafeViewsOfASquare, TrianglesSmallerThanAPixelAreSeen) {
    Dataset fine = write_square(folder.path() / "d", fan());
    Mesh& mesh = fine.mesh;
    mesh.positions.clear();
    mesh.triangles.clear();
    constexpr uint32_t side = 200;  // of the square's 30 pixels
    for (uint32_t y = 0; y <= side; ++y)
        for (uint32_t x = 0; x <= side; ++x)
            mesh.positions.push_back({2.0f * float(x) / side - 1, 2.0f * float(y) / side - 1, 0});
    for (uint32_t y = 0; y < side; ++y)
        for (uint32_t x = 0; x < side; ++x) {
            const uint32_t corner = y * (side + 1) + x;
            mesh.triangles.push_back({corner, corner + 1, corner + side + 2});
            mesh.triangles.push_back({corner, corner + side + 2, corner + side + 1});
        }
    const auto atlas = std::make_shared<const TriangleAtlas>(mesh, 2);
    const SafeViews of_fine(fine, fine.split(false), atlas, SurfaceLookup::linear, runaway_fit);
    for (const std::vector<uint32_t>& views : of_fine.views_of_vertices()) EXPECT_EQ(views.size(), 5u);
}

TEST_F(SafeViewsOfASquare, ThreadsFindTheSame) {
    photograph(fan());
    const std::vector<RasterPixel> pixels = {{0, 0.1f, 0.1f}, {1, 0.3f, 0.3f}, {2, 0.2f, 0.6f}, {3, 0.5f, 0.4f}};
    std::vector<std::vector<float>> rgb(64);
    parallel_for(rgb.size(), 1, [&](size_t i, int worker) { shown.shade(seen_from(50), pixels, rgb[i], worker); });
    for (const auto& other : rgb) EXPECT_EQ(other, rgb[0]);
    const auto all = bounds->all_bounds();
    for (const SafeViews::Bounds& texel : all) EXPECT_LE(texel.mean.x(), 0.5f);
}

}  // namespace
}  // namespace radiafit::testing

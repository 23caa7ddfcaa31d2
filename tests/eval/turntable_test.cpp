// Paths of turntables, and how pictures are framed.
#include "eval/turntable.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "base/rng.h"
#include "eval/render.h"
#include "geometry/direction_hull.h"

namespace radiafit {
namespace {

constexpr double degree = std::numbers::pi / 180;

Vec3d place(double azimuth, double elevation, double distance = 1) {
    return distance * Vec3d(std::cos(elevation * degree) * std::cos(azimuth * degree),
                            std::cos(elevation * degree) * std::sin(azimuth * degree), std::sin(elevation * degree));
}
double elevation_of(const Vec3d& at) { return std::asin(at.normalized().z()) / degree; }
double azimuth_of(const Vec3d& at) { return std::atan2(at.y(), at.x()) / degree; }

/// From `from` to `to` degrees of azimuth, at any of `elevations`.
std::vector<Vec3d> arc(double from, double to, std::vector<double> elevations, double distance = 3) {
    std::vector<Vec3d> out;
    for (double a = from; a <= to; a += 10)
        for (const double e : elevations) out.push_back(place(a, e, distance));
    return out;
}

TEST(Turntable, GoesAllAroundWherePhotographsDo) {
    const ClosedPath path = closed_path(arc(0, 350, {20, 40}), Vec3d::UnitZ(), 12, false);
    ASSERT_EQ(path.places.size(), 12u);
    EXPECT_NEAR(path.span, 2 * std::numbers::pi, 1e-12);
    for (size_t i = 0; i < 12; ++i) {
        EXPECT_NEAR(path.places[i].norm(), 3, 1e-6);
        EXPECT_NEAR(elevation_of(path.places[i]), 30, 0.1);
        const double step = azimuth_of(path.places[(i + 1) % 12]) - azimuth_of(path.places[i]);
        EXPECT_NEAR(std::remainder(step - 30, 360), 0, 1e-6);
    }
    EXPECT_LT(path.farthest, 12 * degree);
}

TEST(Turntable, StaysWithinTheArcThatWasPhotographed) {
    const std::vector<Vec3d> given = arc(100, 260, {-5, 10, 25});  // across where azimuths jump
    std::vector<Vec3d> directions;
    for (const Vec3d& at : given) directions.push_back(at.normalized());
    const ClosedPath path = closed_path(given, Vec3d::UnitZ(), 40, false);
    EXPECT_NEAR(path.span / degree, 160, 1e-6);
    for (size_t i = 0; i < path.places.size(); ++i) {
        EXPECT_EQ(angle_outside(directions, path.places[i].normalized()), 0) << i;
        const double step = std::acos(
            std::min(1.0, path.places[i].normalized().dot(path.places[(i + 1) % path.places.size()].normalized())));
        EXPECT_LT(step, 20 * degree) << "closed, without jumps";
    }
    EXPECT_GT(elevation_of(path.places[0]) - elevation_of(path.places[20]), 10) << "there and back differ";
    EXPECT_LT(path.farthest, 15 * degree);

    const ClosedPath circle = closed_path(given, Vec3d::UnitZ(), 40, true);
    EXPECT_NEAR(circle.span / degree, 360, 1e-6);
    EXPECT_GT(circle.farthest, 80 * degree);
}

TEST(Turntable, TakesTheRunWithTheMostPlaces) {
    std::vector<Vec3d> given = arc(0, 40, {10});
    for (const Vec3d& more : arc(150, 250, {10})) given.push_back(more);
    const ClosedPath path = closed_path(given, Vec3d::UnitZ(), 24, false);
    EXPECT_NEAR(path.span / degree, 100, 1e-6);
    for (const Vec3d& at : path.places) EXPECT_LT(std::abs(std::remainder(azimuth_of(at) - 200, 360)), 50 + 1e-6);
}

TEST(Turntable, NearTheAxisAGapOfAzimuthIsASmallOne) {
    std::vector<Vec3d> given;
    for (const double azimuth : {0, 90, 180, 270}) given.push_back(place(azimuth, 70));
    const ClosedPath path = closed_path(given, Vec3d::UnitZ(), 24, false);
    EXPECT_NEAR(path.span / degree, 360, 1e-6);
    EXPECT_LT(path.farthest, 16 * degree);
    for (Vec3d& at : given) at = place(azimuth_of(at), 20);
    EXPECT_LT(closed_path(given, Vec3d::UnitZ(), 24, false).span, 1e-9) << "one of four, each alone";
}

TEST(Turntable, OneOrNoAzimuthDoes) {
    const std::vector<Vec3d> alone = {place(77, 20, 2)};
    for (const Vec3d& at : closed_path(alone, Vec3d::UnitZ(), 5, false).places) EXPECT_LT((at - alone[0]).norm(), 1e-9);
    const std::vector<Vec3d> top = {{0, 0, 1}};  // at the axis: it stays there, too
    for (const Vec3d& at : closed_path(top, Vec3d::UnitZ(), 5, false).places) EXPECT_LT((at - top[0]).norm(), 1e-9);
}

TEST(Turntable, FollowsHeightAndDistance) {
    std::vector<Vec3d> given;
    for (int a = 0; a < 360; a += 5) given.push_back(place(a, a < 180 ? 10 : 50, a < 180 ? 2 : 4));
    for (const Vec3d& at : closed_path(given, Vec3d::UnitZ(), 36, false).places) {
        const double from_edge = std::abs(std::abs(std::remainder(azimuth_of(at) - 90, 360)) - 90);
        if (from_edge < 85) continue;  // three standard deviations of the Gaussian or so
        const bool low = azimuth_of(at) > 0;
        EXPECT_NEAR(elevation_of(at), low ? 10 : 50, 0.5);
        EXPECT_NEAR(at.norm(), low ? 2 : 4, 0.05);
    }
}

TEST(Turntable, FramesTheObject) {
    Rng rng(3);
    Mesh mesh;
    for (int i = 0; i < 60; ++i)
        mesh.positions.push_back({rng.uniform(-1, 1), rng.uniform(-0.3f, 0.3f), rng.uniform(2, 5)});
    for (uint32_t i = 0; i + 2 < 60; ++i) mesh.triangles.push_back({i, i + 1, i + 2});
    mesh.positions.push_back({100, 100, 100});  // unreferenced: it is no part of the object
    const Vec3d centre(0, 0, 3.5);
    const ClosedPath path = closed_path(arc(0, 350, {25}, 6), Vec3d::UnitZ(), 16, false);
    for (const auto& [width, height] : {std::pair(640, 360), std::pair(300, 900)}) {
        const auto cameras = framing_cameras(mesh, centre, path.places, Vec3d::UnitZ(), width, height);
        ASSERT_EQ(cameras.size(), 16u);
        double nearest = 1;  // to the rim, as a share of the picture
        for (const Camera& camera : cameras) {
            EXPECT_EQ(camera.fx, cameras[0].fx) << "it does not pulse";
            for (size_t i = 0; i < 60; ++i) {
                const Vec3d at = camera.project(mesh.positions[i].cast<double>());
                for (const double x : {at.x() / width, 1 - at.x() / width, at.y() / height, 1 - at.y() / height})
                    nearest = std::min(nearest, x);
            }
        }
        EXPECT_NEAR(nearest, frame_margin, 1e-9) << "neither cut off nor small";
    }
}

TEST(Frame, ThePhotographAroundTheStoredRectangle) {
    View view;
    view.camera = Camera::look_at({3, 0, 0}, {0, 0, 0}, {0, 0, 1}, 0.5, 200, 100);
    const Vec3d before = view.camera.project({0.1, 0.2, 0.3});
    view.crop_origin = {30, 7};
    view.full_size = {640, 480};
    const Camera whole = photograph_camera(view);
    EXPECT_EQ(whole.width, 640);
    EXPECT_EQ(whole.height, 480);
    EXPECT_LT((whole.project({0.1, 0.2, 0.3}) - before - Vec3d(30, 7, 0)).norm(), 1e-9);
    view.full_size = {229, 480};  // the rectangle does not lie in it
    EXPECT_EQ(photograph_camera(view).width, 200);
    view.full_size = {65536, 65536};
    EXPECT_EQ(photograph_camera(view).width, 200);
    view.full_size = {0, 0};  // unknown
    EXPECT_EQ(photograph_camera(view).width, 200);
}

TEST(Frame, IsScaledIntoASize) {
    const Camera camera = Camera::look_at({3, 0, 0}, {0, 0, 0}, {0, 0, 1}, 0.5, 200, 100).cropped(5, -3, 200, 100);
    const Camera fitted = fitted_into(camera, 500, 500);
    const auto moved = [&](double x, double y) {  // 2.5 times as large, in the middle of a square
        return Vec3d(2.5 * x, 2.5 * y + 125, 0);
    };
    for (const Vec3d& point : {Vec3d(0.1, 0.2, 0.3), Vec3d(-0.5, 0.4, 0.1)}) {
        const Vec3d before = camera.project(point), after = fitted.project(point);
        EXPECT_LT((Vec3d(after.x(), after.y(), 0) - moved(before.x(), before.y())).norm(), 1e-9);
    }
    EXPECT_EQ(fitted.width, 500);
    EXPECT_EQ(fitted.height, 500);
}

TEST(Background, MixesInLinearLight) {
    // Nothing, all and half of a white object.
    const LightImage image{3, 1, {0, 0, 0, 1, 1, 1, 0.5f, 0.5f, 0.5f}, {0, 1, 0.5f}};
    EXPECT_EQ(to_bytes(image).rgb, (std::vector<uint8_t>{0, 0, 0, 255, 255, 255, 188, 188, 188}));
    const ByteImage coloured = to_bytes(image, {{10, 200, 255}, false});
    EXPECT_EQ(coloured.channels, 3);
    const auto mixed = [](int byte) {
        return uint8_t(std::lround(255 * srgb_encode(0.5 + 0.5 * srgb_decode(byte / 255.0))));
    };
    EXPECT_EQ(coloured.rgb, (std::vector<uint8_t>{10, 200, 255, 255, 255, 255, mixed(10), mixed(200), mixed(255)}));
    const ByteImage transparent = to_bytes(image, {{}, true});
    EXPECT_EQ(transparent.channels, 4);
    EXPECT_EQ(transparent.rgb, (std::vector<uint8_t>{0, 0, 0, 0, 255, 255, 255, 255, 255, 255, 255, 128}));
}

TEST(Turntable, ExposureIsThePhotographs) {
    const LightImage image{1, 1, {0.5f, 0.6f, 0.8f}, {1}};
    EXPECT_EQ(in_exposure(image, Gain(2)).rgb, (std::vector<float>{0.25f, 0.3f, 0.4f}));
    EXPECT_EQ(in_exposure(image, Gain({1, 2, 4})).rgb, (std::vector<float>{0.5f, 0.3f, 0.2f}));
}

}  // namespace
}  // namespace radiafit

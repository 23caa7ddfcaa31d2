// Planes, patches, sweeps and agreement, against a sphere whose depths are known in closed form.
#include <gtest/gtest.h>

#include <algorithm>

#include "base/error.h"
#include "stereo/agreement.h"
#include "stereo/patch.h"
#include "stereo/patch_match.h"
#include "stereo/region.h"
#include "stereo/source_views.h"
#include "stereo_scene.h"

namespace radiafit {
using namespace tools;
namespace {

using namespace testing;

/// Where the second camera sees the point of the plane at pixel (x, y) of the first.
Vec3d through_plane(const Camera& from, const Camera& to, const Vec3d& point, const Vec3d& normal, double x, double y) {
    const Vec3d ray((x - from.cx) / from.fx, (y - from.cy) / from.fy, 1);
    return to.project(world_of(from, ray * (normal.dot(point) / normal.dot(ray))));
}

TEST(CameraPair, MapsPointsOfThePlaneAndTheirNeighbours) {
    const auto cameras = cameras_around(2, 17, 300);
    const CameraPair pair(cameras[0], cameras[1]);
    for (int trial = 0; trial < 200; ++trial) {
        Rng rng(3, uint64_t(trial));
        const double x = double(rng.uniform(20, 280)), y = double(rng.uniform(20, 280));
        const Vec3d ray((x - cameras[0].cx) / cameras[0].fx, (y - cameras[0].cy) / cameras[0].fy, 1);
        const Vec3d point = ray * double(rng.uniform(4, 6));
        const Vec3d normal = Vec3d(double(rng.uniform(-0.6f, 0.6f)), double(rng.uniform(-0.6f, 0.6f)), -1).normalized();
        const Vec3f r = ray_of(cameras[0], x, y);
        const InversePlane plane = make_plane(r, float(1 / point.z()), normal.cast<float>());
        EXPECT_NEAR(plane.dot(point.cast<float>()), 1, 1e-5);
        EXPECT_LT((normal_of(plane) - normal.cast<float>()).norm(), 1e-5);
        const AffineMap map = pair.map(plane, r);
        const auto at = [&](double dx, double dy) {
            return through_plane(cameras[0], cameras[1], point, normal, x + dx, y + dy);
        };
        const double h = 0.01;
        const Vec3d here = at(0, 0), by_x = (at(h, 0) - at(-h, 0)) / (2 * h), by_y = (at(0, h) - at(0, -h)) / (2 * h);
        // single precision of coordinates of some hundred pixels
        EXPECT_NEAR(map.x, here.x(), 2e-3);
        EXPECT_NEAR(map.y, here.y(), 2e-3);
        EXPECT_NEAR(map.depth * point.z(), here.z(), 1e-4);
        EXPECT_NEAR(map.x_dx, by_x.x(), 1e-4);
        EXPECT_NEAR(map.y_dx, by_x.y(), 1e-4);
        EXPECT_NEAR(map.x_dy, by_y.x(), 1e-4);
        EXPECT_NEAR(map.y_dy, by_y.y(), 1e-4);
    }
}

TEST(Region, IsABallAroundWhereCamerasLook) {
    const auto cameras = cameras_around(6, 40, 200);
    const SearchBall region = region_of(cameras, 1.0);
    EXPECT_LT(region.centre.norm(), 1e-6);
    EXPECT_NEAR(region.radius, 5 * std::sin(0.24), 0.02);  // of the field of view; distances are 5 to 5.01
    for (const auto& [x, y] : {std::array{100.5, 90.0}, {40.0, 60.0}, {150.0, 180.0}}) {
        const auto range = inverse_depths(region, cameras[1], x, y);
        ASSERT_TRUE(range);
        EXPECT_LT((*range)[0], (*range)[1]);
        for (const float inverse : *range) {
            const Vec3d ray = ray_of(cameras[1], x, y).cast<double>();
            EXPECT_NEAR((world_of(cameras[1], ray / double(inverse)) - region.centre).norm(), region.radius, 1e-5);
        }
    }
    EXPECT_FALSE(inverse_depths(region, cameras[1], 1, 1));
    EXPECT_THROW(region_of(std::vector<Camera>(3, cameras[0]), 1), UserError);
}

TEST(SourceViews, PreferAModerateAngle) {
    std::vector<Camera> cameras = cameras_around(9, 4, 100);  // 4 degrees apart
    for (Camera& c : cameras) c.cam_from_world_translation.y() = 0;
    std::vector<SparsePoint> points(40);
    for (size_t p = 0; p < points.size(); ++p) {
        points[p].position = Vec3d(0.001 * double(p), 0, 0);
        for (uint32_t i = 0; i < 8; ++i) points[p].images.push_back(i);  // the last camera sees nothing
    }
    const auto sources = choose_sources(cameras, points, 3);
    ASSERT_EQ(sources.size(), 9u);
    EXPECT_EQ(sources[0], (std::vector<uint32_t>{2, 3, 4}));  // 8, 12 and 16 degrees; 4 tell less of depth
    EXPECT_TRUE(sources[8].empty());
    points.resize(9);
    EXPECT_TRUE(choose_sources(cameras, points, 3)[0].empty());
}

TEST(Patch, CostIsFreeOfGainAndOffset) {
    const GreyImage image = photograph_of_sphere(cameras_around(1, 0, 120)[0]);
    GreyImage other = image;
    for (float& v : other.values) v = 0.5f * v + 0.2f;
    Patch patch;
    ASSERT_TRUE(patch.take(image, 60, 55));
    const AffineMap same{60.5f, 55.5f, 1, 0, 0, 1, 1};
    EXPECT_NEAR(patch.cost(image, same), 0, 1e-5);
    EXPECT_NEAR(patch.cost(other, same), 0, 1e-4);
    EXPECT_GT(patch.cost(image, {66.5f, 55.5f, 1, 0, 0, 1, 1}), 0.2f);
    for (float& v : other.values) v = -v;
    EXPECT_NEAR(patch.cost(other, same), worst_cost, 1e-4);
    EXPECT_EQ(patch.cost(image, {118.5f, 55.5f, 1, 0, 0, 1, 1}), worst_cost);       // leaves the image
    EXPECT_EQ(patch.cost(image, {60.5f, 55.5f, 0.3f, 0, 0, 0.3f, 1}), worst_cost);  // far too small
    EXPECT_EQ(patch.cost(image, {60.5f, 55.5f, 1, 0, 0, 1, -1}), worst_cost);       // behind
    EXPECT_FALSE(patch.take(image, 3, 55));
    for (float& v : other.values) v = 0.3f;
    EXPECT_FALSE(patch.take(other, 60, 55));
    EXPECT_EQ(patch.cost(other, same), worst_cost);
}

TEST(PatchMatch, FindsTheSphere) {
    const auto cameras = cameras_around(5, 8, 240);
    std::vector<Pyramid> pyramids;
    for (const Camera& camera : cameras) pyramids.push_back(pyramid_of(photograph_of_sphere(camera)));
    ASSERT_EQ(pyramids[0].size(), 2u);
    const std::vector<const Pyramid*> sources = {&pyramids[0], &pyramids[1], &pyramids[3], &pyramids[4]};
    const SearchBall region = region_of(cameras, 1.2);
    const PlaneMap map = match_patches(pyramids[2], sources, region, 0.5f, 1);
    const PlaneMap truth = planes_of_sphere(cameras[2]);
    size_t seen = 0, near = 0, tilted = 0, wrong = 0;
    for (size_t i = 0; i < map.planes.size(); ++i) {
        const Vec3f ray = ray_of(cameras[2], double(i % 240) + 0.5, double(i / 240) + 0.5);
        if (!truth.known(i) || facing(truth.planes[i], ray) < 0.5f) continue;  // the rim is other photographs' part
        ++seen;
        if (!map.known(i)) continue;
        const bool right =
            std::abs(map.planes[i].dot(ray) / truth.planes[i].dot(ray) - 1) < 0.004f;  // 1 % of the diameter
        near += right;
        wrong += !right;
        tilted += normal_of(map.planes[i]).dot(normal_of(truth.planes[i])) < 0.87f;  // 30 degrees
    }
    EXPECT_GT(double(near) / double(seen), 0.95);
    EXPECT_LT(double(wrong) / double(seen), 0.03);
    EXPECT_LT(double(tilted) / double(seen), 0.1);
    EXPECT_EQ(match_patches(pyramids[2], sources, region, 0.5f, 1).planes, map.planes);
}

TEST(Agreement, KeepsWhatOthersSeeToo) {
    const auto cameras = cameras_around(3, 12, 160);
    std::vector<PlaneMap> maps;
    for (const Camera& camera : cameras) maps.push_back(planes_of_sphere(camera));
    const std::vector<const PlaneMap*> others = {&maps[0], &maps[2]};
    const PlaneMap agreed = agreed_planes(maps[1], others, 2);
    EXPECT_GT(double(agreed.known_count()), 0.75 * double(maps[1].known_count()));  // what both others see
    for (size_t i = 0; i < agreed.planes.size(); ++i)
        if (agreed.known(i)) {
            EXPECT_EQ(agreed.planes[i], maps[1].planes[i]);
        }

    PlaneMap nearer = maps[1];
    for (InversePlane& plane : nearer.planes) plane *= 1.02f;
    const PlaneMap off = agreed_planes(nearer, others, 1);
    for (size_t i = 0; i < off.planes.size(); ++i) {  // towards the rim the ray runs along the surface
        const Vec3f ray = ray_of(cameras[1], double(i % 160) + 0.5, double(i / 160) + 0.5);
        EXPECT_FALSE(off.known(i) && facing(maps[1].planes[i], ray) > 0.5f);
    }
    EXPECT_LT(double(off.known_count()), 0.02 * double(maps[1].known_count()));
    EXPECT_GT(agreed_planes(maps[1], {others.begin(), 1}, 1).known_count(), agreed.known_count());
    EXPECT_EQ(agreed_planes(maps[1], {others.begin(), 1}, 2).known_count(), 0u);
}

}  // namespace
}  // namespace radiafit

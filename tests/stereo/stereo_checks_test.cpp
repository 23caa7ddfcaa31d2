// Whether cameras and meshes are good enough, masks from meshes, and meshes cut to the object.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "capture/colmap.h"
#include "capture_fixture.h"
#include "dataset/mesh_ply.h"
#include "image/image_file.h"
#include "stereo/masks.h"
#include "stereo/mesh_check.h"
#include "stereo/mesh_cut.h"
#include "stereo/model_check.h"
#include "stereo_scene.h"

namespace radiafit {
using namespace tools;
namespace {

using namespace testing;

constexpr int side = 120;

/// Six photographs of the sphere, calibrated, of which the model has `registered`, and 300 points on the sphere moved
/// out by `away`, each in the tracks of those that see it.
class Checks : public FolderTest {
protected:
    std::vector<Camera> cameras_ = cameras_around(6, 12, side);

    void write_model(size_t registered, double error, double away) {
        std::string cameras, images, points;
        for (size_t i = 0; i < cameras_.size(); ++i) {
            write_bytes(root_ / fmt::format("photos/{}.png", i),
                        encode_png(side, side, 1, 8, std::vector<uint16_t>(side * side, 9)));
            if (i >= registered) continue;
            const Camera& c = cameras_[i];
            const Eigen::Quaterniond q(c.cam_from_world_rotation);
            const Vec3d& t = c.cam_from_world_translation;
            cameras += fmt::format("{} PINHOLE {} {} {} {} {} {}\n", i + 1, side, side, c.fx, c.fy, c.cx, c.cy);
            images += fmt::format("{} {} {} {} {} {} {} {} {} {}.png\n\n", i + 1, q.w(), q.x(), q.y(), q.z(), t.x(),
                                  t.y(), t.z(), i + 1, i);
        }
        Rng rng(5);
        for (int k = 0; k < 300; ++k) {
            const auto across = [&] { return double(rng.uniform(-0.4f, 0.4f)); };
            const Vec3d p = Vec3d(across(), across(), 1).normalized() * (1 + away);
            points += fmt::format("{} {} {} {} 0 0 0 {}", k, p.x(), p.y(), p.z(), error);
            for (size_t i = 0; i < registered; ++i) points += fmt::format(" {} {}", i + 1, k);
            points += "\n";
        }
        write_bytes(root_ / "model/cameras.txt", cameras);
        write_bytes(root_ / "model/images.txt", images);
        write_bytes(root_ / "model/points3D.txt", points);
    }
};

TEST_F(Checks, ModelIsCountedAndJudged) {
    write_model(6, 0.5, 0);
    const ModelCheck good = check_model(root_ / "model", root_ / "photos");
    EXPECT_EQ(good.registered, 6u);
    EXPECT_EQ(good.points, 300u);
    EXPECT_NEAR(good.reprojection_error, 0.5, 1e-9);
    EXPECT_NEAR(good.track_length, 6, 1e-9);
    EXPECT_TRUE(good.poor.empty());
    EXPECT_EQ(good.photographs[2].points, 300u);

    write_model(4, 1.75, 0);
    const ModelCheck poor = check_model(root_ / "model", root_ / "photos");
    ASSERT_EQ(poor.poor.size(), 2u);
    expect_in("only 4 of 6 photographs were registered, not 4.png, 5.png: take more photographs", poor.poor[0]);
    expect_in("the mean reprojection error is 1.75 pixels, above 1.5", poor.poor[1]);
    write_model(2, 0.5, 0);
    expect_in("points are seen by 2.0 photographs in the mean", check_model(root_ / "model", root_ / "photos").poor[1]);
}

TEST_F(Checks, MeshIsHeldAgainstPointsAndMasks) {
    write_model(6, 0.5, 0);
    write_ply(sphere_mesh(Vec3d::Zero(), 1, 60, 120), root_ / "mesh.ply");
    write_mesh_masks(sphere_mesh(Vec3d::Zero(), 1, 60, 120), read_colmap(root_ / "model"), 0, root_ / "masks");
    const auto check = [&](const fs::path& masks) {
        return check_mesh({root_ / "mesh.ply", root_ / "model", {}, root_ / "photos", masks});
    };
    const MeshCheck good = check(root_ / "masks");
    EXPECT_TRUE(good.poor.empty());
    EXPECT_LT(good.distance, 0.001);
    EXPECT_EQ(good.near_share, 1);
    EXPECT_EQ(good.points, 6 * 300u);
    EXPECT_NEAR(good.overlap, 1, 1e-9);
    EXPECT_NEAR(good.share, 3.1416 * std::pow(std::tan(std::asin(0.2)) / (2 * std::tan(0.24)), 2), 0.02);

    write_model(6, 0.5, 0.05);
    const MeshCheck away = check({});
    ASSERT_EQ(away.poor.size(), 1u);
    expect_in("of the mesh's diagonal away from it in the median", away.poor[0]);
    EXPECT_NEAR(away.distance, 0.05 / std::sqrt(12.0), 0.002);

    write_model(6, 0.5, 0);
    write_ply(sphere_mesh({0.3, 0, 0}, 0.6, 60, 120), root_ / "mesh.ply");
    const MeshCheck smaller = check(root_ / "masks");
    ASSERT_EQ(smaller.poor.size(), 2u);
    expect_in("mesh and masks agree on", smaller.poor[1]);
}

TEST_F(Checks, MasksAreInset) {
    write_model(6, 0.5, 0);
    const Calibration model = read_colmap(root_ / "model");
    const Mesh mesh = sphere_mesh(Vec3d::Zero(), 1, 60, 120);
    write_mesh_masks(mesh, model, 0, root_ / "whole");
    write_mesh_masks(mesh, model, 3, root_ / "inset");
    const MaskFile whole = read_mask(root_ / "whole/2.png"), inset = read_mask(root_ / "inset/2.png");
    for (int y = 3; y < side - 3; ++y)
        for (int x = 3; x < side - 3; ++x) {
            bool all = true;
            for (int dy = -3; dy <= 3; ++dy)
                for (int dx = -3; dx <= 3; ++dx) all = all && whole.values[size_t((y + dy) * side + x + dx)];
            ASSERT_EQ(inset.values[size_t(y * side + x)], all ? 255 : 0) << x << ", " << y;
        }
}

TEST_F(Checks, MeshIsCutToWhatDepthMapsSupport) {
    Mesh mesh = sphere_mesh(Vec3d::Zero(), 1, 60, 120);
    const size_t of_sphere = mesh.vertex_count();
    const auto add = [&](const Mesh& other) {
        for (auto t : other.triangles) {
            for (uint32_t& v : t) v += uint32_t(mesh.vertex_count());
            mesh.triangles.push_back(t);
        }
        mesh.positions.insert(mesh.positions.end(), other.positions.begin(), other.positions.end());
    };
    add(sphere_mesh({0, 0, -20}, 1, 8, 16));       // far away
    add(sphere_mesh({0, 1.2, 0.2}, 0.05, 8, 16));  // near, and no depth agrees with it
    std::vector<PlaneMap> maps;
    for (const Camera& camera : cameras_) maps.push_back(planes_of_sphere(camera));
    for (PlaneMap& map : maps)  // a hole that all have
        for (int y = 55; y < 60; ++y)
            for (int x = 0; x < side; ++x) map.planes[size_t(y * side + x)] = InversePlane::Zero();
    std::vector<std::vector<uint8_t>> masks(maps.size());
    const SearchBall region = region_of(cameras_, 1.3);
    CutReport report;
    const Mesh cut = cut_mesh(mesh, maps, masks, region, {}, report);
    EXPECT_EQ(report.vertices, mesh.vertex_count());
    EXPECT_GE(report.off_region, 100u);
    EXPECT_GT(cut.vertex_count(), of_sphere / 3);  // the side that cameras see
    EXPECT_LT(cut.vertex_count(), of_sphere * 3 / 4);
    double lowest = 1;
    for (const Vec3f& p : cut.positions) {
        EXPECT_NEAR(p.norm(), 1, 5e-3);  // those on borders are smoothed within their tangent plane
        lowest = std::min(lowest, double(p.z()));
    }
    EXPECT_GT(lowest, -0.9);
    CutOptions open;
    open.close = 0;
    const Mesh with_hole = cut_mesh(mesh, maps, masks, region, open, report);
    EXPECT_LT(with_hole.vertex_count(), cut.vertex_count());  // the hole cuts it in two

    for (auto& mask : masks) mask.assign(side * side, 0);
    for (auto& mask : masks)
        for (int y = 60; y < side; ++y) std::fill_n(mask.begin() + y * side, side, uint8_t(255));
    for (const Vec3f& p : cut_mesh(mesh, maps, masks, region, {}, report).positions) EXPECT_LT(p.y(), 0.15f);
    EXPECT_GT(report.off_masks, 0u);
    for (auto& mask : masks) mask.assign(side * side, 0);
    expect_in("nothing of the mesh is left", complaint([&] { cut_mesh(mesh, maps, masks, region, {}, report); }));
}

}  // namespace
}  // namespace radiafit

#include "capture/pose_form.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

namespace radiafit {
using namespace tools;
namespace {

Camera some_camera() {
    Camera camera;
    camera.cam_from_world_rotation = Eigen::AngleAxisd(0.7, Vec3d(1, -2, 0.5).normalized()).toRotationMatrix();
    camera.cam_from_world_translation = Vec3d(0.3, -1.2, 4);
    return camera;
}

void expect_same(const Camera& a, const Camera& b) {
    EXPECT_TRUE(a.cam_from_world_rotation.isApprox(b.cam_from_world_rotation, 1e-12));
    EXPECT_TRUE(a.cam_from_world_translation.isApprox(b.cam_from_world_translation, 1e-12));
}

TEST(PoseForm, ReadingOtherwiseAndBackChangesNothing) {
    const Camera camera = some_camera();
    for (const bool to_world : {false, true})
        for (const CameraAxes axes : {CameraAxes::opencv, CameraAxes::opengl, CameraAxes::llff})
            for (const PoseForm given : {colmap_poses, transforms_poses, llff_poses}) {
                const PoseForm meant{to_world, axes};
                const Camera other = read_otherwise(camera, given, meant);
                EXPECT_NEAR(other.cam_from_world_rotation.determinant(), 1, 1e-12) << "a turn";
                expect_same(read_otherwise(other, meant, given), camera);
                if (given == meant) expect_same(other, camera);
            }
}

TEST(PoseForm, WhatCalibrationsWrite) {
    const Camera camera = some_camera();
    const Mat3d& r = camera.cam_from_world_rotation;
    // A file of poses from the world to the camera, COLMAP's, read as if they took the camera to the world.
    const Camera inverted = read_otherwise(camera, colmap_poses, {true, CameraAxes::opencv});
    EXPECT_TRUE(inverted.cam_from_world_rotation.isApprox(r.transpose(), 1e-12));
    EXPECT_TRUE(inverted.center().isApprox(camera.cam_from_world_translation, 1e-12));
    // Columns right, up, back, taken for right, down, forward: y and z of the camera are reversed.
    const Camera turned = read_otherwise(camera, transforms_poses, {true, CameraAxes::opencv});
    EXPECT_TRUE(turned.cam_from_world_rotation.isApprox(Vec3d(1, -1, -1).asDiagonal() * r, 1e-12));
    EXPECT_TRUE(turned.center().isApprox(camera.center(), 1e-12));
}

}  // namespace
}  // namespace radiafit

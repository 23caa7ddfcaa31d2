#include "capture/pose_form.h"

namespace radiafit::tools {
namespace {

/// The columns: a form's axes in those of Camera.
Mat3d axes_matrix(CameraAxes axes) {
    if (axes == CameraAxes::opengl) return Vec3d(1, -1, -1).asDiagonal();
    if (axes == CameraAxes::llff) return (Mat3d() << 0, 1, 0, 1, 0, 0, 0, 0, -1).finished();
    return Mat3d::Identity();
}

}  // namespace

Camera read_otherwise(const Camera& camera, PoseForm given, PoseForm meant) {
    const Mat3d& r = camera.cam_from_world_rotation;
    const Mat3d given_axes = axes_matrix(given.axes), meant_axes = axes_matrix(meant.axes);
    // What stands in the file.
    const Mat3d linear = given.to_world ? Mat3d(r.transpose() * given_axes) : Mat3d(given_axes.transpose() * r);
    const Vec3d shift =
        given.to_world ? camera.center() : Vec3d(given_axes.transpose() * camera.cam_from_world_translation);
    Camera result = camera;
    if (meant.to_world) {
        result.cam_from_world_rotation = meant_axes * linear.transpose();
        result.cam_from_world_translation = -(result.cam_from_world_rotation * shift);
    } else {
        result.cam_from_world_rotation = meant_axes * linear;
        result.cam_from_world_translation = meant_axes * shift;
    }
    return result;
}

const char* describe_axes(CameraAxes axes) {
    if (axes == CameraAxes::opengl) return "right, up and back";
    return axes == CameraAxes::llff ? "down, right and back" : "right, down and forward";
}

}  // namespace radiafit::tools

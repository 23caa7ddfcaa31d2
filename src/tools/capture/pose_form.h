#pragma once
#include "geometry/camera.h"

namespace radiafit::tools {

/// A camera's own axes x, y and z, as calibrations have them.
enum class CameraAxes {
    opencv,  ///< right, down, forward: COLMAP's, and those of Camera
    opengl,  ///< right, up, back: transforms.json's
    llff,    ///< down, right, back
};

/// How a format writes poses.
struct PoseForm {
    bool to_world = false;  ///< they take cameras to the world, else the world to cameras
    CameraAxes axes = CameraAxes::opencv;
    bool operator==(const PoseForm&) const = default;
};
inline constexpr PoseForm colmap_poses = {false, CameraAxes::opencv}, transforms_poses = {true, CameraAxes::opengl},
                          llff_poses = {true, CameraAxes::llff};

/// The pose of `camera`, which was read as `given` says, if the file's numbers were meant as `meant` says.
Camera read_otherwise(const Camera& camera, PoseForm given, PoseForm meant);

/// "right, down and forward"
const char* describe_axes(CameraAxes axes);

}  // namespace radiafit::tools

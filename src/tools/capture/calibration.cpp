#include "capture/calibration.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>

#include "base/error.h"

namespace radiafit::tools {

void sort_images(Calibration& calibration) {
    std::vector<CalibratedImage>& images = calibration.images;
    if (images.empty())
        throw UserError(
            fmt::format("{}: holds no image: register photographs first", calibration.images_file.string()));
    std::sort(images.begin(), images.end(),
              [](const CalibratedImage& a, const CalibratedImage& b) { return a.name < b.name; });
    for (size_t i = 1; i < images.size(); ++i)
        if (images[i].name == images[i - 1].name)
            throw UserError(fmt::format("{}: image '{}' is given twice: remove one", calibration.images_file.string(),
                                        images[i].name));
}

void set_pose(Camera& camera, const Mat3d& axes, const Vec3d& centre, const std::string& where) {
    if (!axes.allFinite() || !centre.allFinite())
        throw UserError(fmt::format("{}: the pose is not finite (NaN or infinity): calibrate again", where));
    const double off = (axes.transpose() * axes - Mat3d::Identity()).cwiseAbs().maxCoeff();
    if (!(off <= 1e-3) || axes.determinant() <= 0)
        throw UserError(
            fmt::format("{}: the pose's first three columns are no rotation ({}): write it without scale or mirroring",
                        where, off <= 1e-3 ? "left-handed" : fmt::format("{:.2g} off", off)));
    const Eigen::JacobiSVD<Mat3d> svd(axes, Eigen::ComputeFullU | Eigen::ComputeFullV);
    camera.cam_from_world_rotation = svd.matrixV() * svd.matrixU().transpose();  // of the nearest rotation, the inverse
    camera.cam_from_world_translation = -camera.cam_from_world_rotation * centre;
    check_camera(camera, where);
}

}  // namespace radiafit::tools

#include "capture/calibration.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <map>

#include "base/error.h"
#include "base/read_file.h"
#include "base/wording.h"
#include "capture/image_finder.h"

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

void locate_photographs(Calibration& calibration, const std::filesystem::path& images, bool skip_missing,
                        std::vector<std::string>& notes) {
    if (!folder_exists(images))
        throw UserError(
            fmt::format("{}: no such folder of photographs: check {}", images.string(), option_name("images")));
    ImageFinder finder(images, calibration.images_file);
    std::vector<std::string> missing;
    std::map<std::filesystem::path, std::string> named;
    for (CalibratedImage& image : calibration.images) {
        const std::string name = image.name;
        if (image.file.empty())
            if (const auto found = finder.find(name)) {
                image.file = images / *found;
                image.name = found->generic_string();
            }
        if (image.file.empty()) {
            missing.push_back(name);
            continue;
        }
        check_readable(image.file, "image file");
        if (const auto [other, is_new] = named.emplace(image.file.lexically_normal(), name); !is_new)
            throw UserError(fmt::format("{}: '{}' and '{}' mean one photograph, {}: take one out, or give the other's",
                                        calibration.images_file.string(), other->second, name, image.file.string()));
    }
    const size_t all = calibration.images.size();
    if (missing.size() == all)
        throw UserError(fmt::format("{}{}: check {}", finder.missing(missing[0]),
                                    all == 1 ? "" : fmt::format(", nor is any other of its {} images there", all),
                                    option_name("images")));
    if (!missing.empty() && !skip_missing)
        throw UserError(fmt::format("{} ({} of {} images are missing): check {}, or give {} to go on without",
                                    finder.missing(missing[0]), missing.size(), all, option_name("images"),
                                    option_name("skip-missing")));
    if (!missing.empty()) {
        std::erase_if(calibration.images, [](const CalibratedImage& image) { return image.file.empty(); });
        notes.push_back(fmt::format("{} of the {} images of {} are not there and are left out: {}", missing.size(), all,
                                    calibration.images_file.string(), fmt::join(missing, ", ")));
    }
    for (std::string& remark : finder.remarks()) calibration.remarks.push_back(std::move(remark));
    sort_images(calibration);
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

#include "capture/llff.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/npy_file.h"
#include "base/read_file.h"
#include "base/wording.h"
#include "capture/file_names.h"
#include "capture/light_file.h"

namespace radiafit::tools {
namespace fs = std::filesystem;
namespace {

constexpr size_t pose_columns = 5, row_length = 17;
constexpr const char* view_list = "view_imgs.txt";  // LLFF's: which of the images COLMAP registered, in any order

int side(double value, const char* what, const std::string& where) {
    if (!(value >= 1 && value <= largest_calibrated_side) || value != std::floor(value))
        throw UserError(fmt::format("{}: the {} is {}, no whole number from 1 to {}: calibrate again", where, what,
                                    value, largest_calibrated_side));
    return static_cast<int>(value);
}

/// numbers: a row of the file.
Camera read_camera(const double* numbers, const std::string& where) {
    const auto column = [&](size_t c) {
        return Vec3d(numbers[c], numbers[c + pose_columns], numbers[c + 2 * pose_columns]);
    };
    const Vec3d lens = column(4);  // height, width, focal length
    Camera camera;
    camera.height = side(lens[0], "height", where);
    camera.width = side(lens[1], "width", where);
    camera.fx = camera.fy = lens[2];
    camera.cx = 0.5 * camera.width;
    camera.cy = 0.5 * camera.height;
    Mat3d axes;
    axes << column(1), column(0), -column(2);  // right, down, forward from down, right, back
    set_pose(camera, axes, column(3), where);
    return camera;
}

}  // namespace

Calibration read_llff(const fs::path& file, const fs::path& images) {
    const NpyReader array(file, "array file");
    if (array.shape().size() != 2 || array.shape()[1] != row_length)
        throw UserError(
            fmt::format("{}: its shape is {}, which should be (images, {}) as in LLFF's poses_bounds.npy: "
                        "write it again by numpy.save",
                        file.string(), array.shape_text(), row_length));
    const std::vector<double> rows = array.read<double>();
    const size_t row_count = rows.size() / row_length;
    if (!folder_exists(images))
        throw UserError(
            fmt::format("{}: no such folder of photographs: check {}", images.string(), option_name("images")));
    Calibration calibration;
    calibration.origin = file.filename().string();
    calibration.cameras_file = calibration.images_file = file;
    calibration.hints.poses = llff_poses;
    std::vector<std::string> names = list_images(images);
    if (names.size() != row_count) {
        const fs::path list = file.parent_path() / view_list;
        if (!path_exists(list))
            throw UserError(
                fmt::format("{}: has {} rows, but {} holds {} images: leave there those that were calibrated, or name "
                            "them in {}, one per line",
                            file.string(), row_count, images.string(), names.size(), list.string()));
        names = read_names(list);
        if (names.size() != row_count)
            throw UserError(fmt::format("{}: has {} rows, but {} names {} images: take both from one calibration",
                                        file.string(), row_count, list.string(), names.size()));
        std::sort(names.begin(), names.end());
        calibration.remarks.push_back(
            fmt::format("{} names the {} images that were calibrated", list.string(), names.size()));
        calibration.images_file = list;
    }
    calibration.size_cure = fmt::format("give the photographs that were calibrated, at that size ({} scales them down)",
                                        option_name("max-size"));
    for (size_t i = 0; i < names.size(); ++i)
        calibration.images.push_back(
            {names[i],
             read_camera(&rows[i * row_length], fmt::format("{}: row {}, image '{}'", file.string(), i, names[i]))});
    sort_images(calibration);
    return calibration;
}

}  // namespace radiafit::tools

#include "capture/colmap.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <span>

#include "base/error.h"
#include "base/read_file.h"
#include "base/statistics.h"
#include "base/text_file.h"
#include "base/wording.h"
#include "capture/colmap_binary.h"

namespace radiafit::tools {
namespace {

struct Model {
    const char* name;
    size_t focal_lengths = 0;  // f, or fx and fy; then cx, cy; 0: refused
    size_t coefficients = 0;   // of distortion, behind them (colmap_lens())
};

/// COLMAP's camera models by their number in binary files (colmap/sensor/models.h).
constexpr std::array<Model, 12> camera_models = {{{"SIMPLE_PINHOLE", 1, 0},
                                                  {"PINHOLE", 2, 0},
                                                  {"SIMPLE_RADIAL", 1, 1},
                                                  {"RADIAL", 1, 2},
                                                  {"OPENCV", 2, 4},
                                                  {"OPENCV_FISHEYE", 2, 4},
                                                  {"FULL_OPENCV", 2, 8},
                                                  {"FOV", 2, 1},
                                                  {"SIMPLE_RADIAL_FISHEYE", 1, 1},
                                                  {"RADIAL_FISHEYE", 1, 2},
                                                  {"THIN_PRISM_FISHEYE", 2, 8},
                                                  {"RAD_TAN_THIN_PRISM_FISHEYE"}}};

/// What an image refers to: a camera without a pose.
struct Intrinsics {
    Camera camera;
    std::optional<Lens> lens;
};

struct CameraList {
    Lenses lenses;
    std::map<uint32_t, Intrinsics> by_id;
};

[[noreturn]] void reject_model(const std::string& where, const std::string& model) {
    throw UserError(
        fmt::format("{}: camera model {} is not a pinhole: undistort images and model first with `colmap "
                    "image_undistorter`",
                    where, model));
}

const Model& find_model(const std::string& where, std::string_view name) {
    for (const Model& model : camera_models)
        if (model.name == name && model.focal_lengths > 0) return model;
    reject_model(where, std::string(name));
}

size_t parameter_count(const Model& model) { return model.focal_lengths + 2 + model.coefficients; }

/// parameters: f or fx, fy; cx, cy; coefficients of distortion.
void add_camera(CameraList& cameras, const std::string& where, uint64_t id, const Model& model, uint64_t width,
                uint64_t height, std::span<const double> parameters) {
    const auto fail = [&](const std::string& problem) {
        throw UserError(fmt::format("{}: camera {} {}: write the model again", where, id, problem));
    };
    if (id > UINT32_MAX) fail("has an id beyond 32 bits");
    if (width < 1 || height < 1 || width > largest_calibrated_side || height > largest_calibrated_side)
        fail(fmt::format("has size {} x {}, outside [1, {}]", width, height, largest_calibrated_side));
    for (const double p : parameters)
        if (!std::isfinite(p)) fail("has a parameter that is not finite (NaN or infinity)");
    const auto distortion = parameters.last(model.coefficients);
    std::optional<Lens> lens = colmap_lens(model.name, distortion);
    if (lens && cameras.lenses == Lenses::refused) {
        const bool distorts = std::any_of(distortion.begin(), distortion.end(), [](double k) { return k != 0; });
        reject_model(where, distorts ? fmt::format("{} with distortion ({})", model.name, fmt::join(distortion, ", "))
                                     : std::string(model.name));
    }
    Camera camera;
    camera.width = static_cast<int>(width);
    camera.height = static_cast<int>(height);
    camera.fx = parameters[0];
    camera.fy = parameters[model.focal_lengths - 1];
    camera.cx = parameters[model.focal_lengths];
    camera.cy = parameters[model.focal_lengths + 1];
    if (camera.fx <= 0 || camera.fy <= 0) fail("has a focal length that is not positive");
    if (!cameras.by_id.emplace(static_cast<uint32_t>(id), Intrinsics{camera, std::move(lens)}).second)
        fail("is given twice");
}

/// The images of a model as they are read, and the lengths of their quaternions.
struct Images {
    struct Length {
        double value;
        std::string where, name;
    };
    Calibration& model;
    const CameraList& cameras;
    std::vector<Length> lengths = {};
};

/// COLMAP writes unit quaternions, others round them or leave all as they come. One that differs from the others was
/// made of other numbers.
void check_lengths(const Images& images) {
    constexpr double rounding = 0.02;
    if (images.lengths.empty()) return;
    std::vector<double> values;
    for (const Images::Length& length : images.lengths) values.push_back(length.value);
    const double usual = median(std::move(values));
    for (const Images::Length& length : images.lengths)
        if (std::abs(length.value - usual) > rounding * usual)
            throw UserError(
                fmt::format("{}: image '{}' has a quaternion QW QX QY QZ of length {:.4g}, the others of {:.4g}: "
                            "write its rotation again (are other numbers in its place?)",
                            length.where, length.name, length.value, usual));
    if (std::abs(usual - 1) > rounding)
        images.model.remarks.push_back(fmt::format("{}: the quaternions have length {:.4g}, not 1: they are normalized",
                                                   images.model.images_file.string(), usual));
}

/// pose: qw, qx, qy, qz, tx, ty, tz, world to camera.
void add_image(Images& images, const std::string& where, uint64_t id, std::string name, uint64_t camera_id,
               const std::array<double, 7>& pose) {
    Calibration& model = images.model;
    const CameraList& cameras = images.cameras;
    const auto fail = [&](const std::string& problem) {
        throw UserError(fmt::format("{}: image '{}' {}", where, name, problem));
    };
    if (name.empty()) fail("has no name: write the model again");
    for (const double p : pose)
        if (!std::isfinite(p)) fail("has a pose that is not finite (NaN or infinity): register it again or remove it");
    const auto camera = cameras.by_id.find(static_cast<uint32_t>(camera_id));
    if (camera_id > UINT32_MAX || camera == cameras.by_id.end())
        fail(fmt::format("refers to camera {}, which {} does not hold: take both files from one model", camera_id,
                         model.cameras_file.string()));
    Eigen::Quaterniond rotation(pose[0], pose[1], pose[2], pose[3]);
    if (!(rotation.norm() > 1e-12)) fail("has a zero quaternion: register it again or remove it");
    if (rotation.norm() < 0.1 || !(rotation.norm() < 10))
        fail(fmt::format("has a quaternion of length {}, far from 1: write the model again", rotation.norm()));
    images.lengths.push_back({rotation.norm(), where, name});
    CalibratedImage image{name, camera->second.camera};
    image.id = id;
    image.lens = camera->second.lens;
    image.camera.cam_from_world_rotation = rotation.normalized().toRotationMatrix();
    image.camera.cam_from_world_translation = {pose[4], pose[5], pose[6]};
    check_camera(image.camera, fmt::format("{}: image '{}'", where, name));
    model.images.push_back(std::move(image));
}

// CAMERA_ID MODEL WIDTH HEIGHT PARAMS[]
CameraList read_cameras_text(const std::filesystem::path& file, Lenses lenses) {
    TextFile text(file, "list of cameras");
    CameraList cameras{lenses, {}};
    for (std::string_view line; text.next_entry(line);) {
        const auto tokens = split_tokens(line);
        if (tokens.size() < 4) text.fail("expected CAMERA_ID MODEL WIDTH HEIGHT PARAMS...: correct the line");
        const Model& model = find_model(text.where(), tokens[1]);
        const size_t count = parameter_count(model);
        if (tokens.size() != 4 + count)
            text.fail(fmt::format("{} takes {} parameters, the line has {}: correct the line", model.name, count,
                                  tokens.size() - 4));
        std::vector<double> parameters;
        for (size_t i = 4; i < tokens.size(); ++i) parameters.push_back(text.to_double(tokens[i], "a parameter"));
        add_camera(cameras, text.where(), text.to_unsigned(tokens[0], "CAMERA_ID"), model,
                   text.to_unsigned(tokens[2], "WIDTH"), text.to_unsigned(tokens[3], "HEIGHT"), parameters);
    }
    return cameras;
}

/// The number in COLMAP's comment "# Number of images: 24, mean observations per image: ..."; none of other lines.
std::optional<uint64_t> announced_images(const TextFile& text, std::string_view line) {
    constexpr std::string_view words = "Number of images:";
    const size_t at = line.find(words);
    if (!line.starts_with('#') || at == std::string_view::npos) return {};
    const auto tokens = split_tokens(line.substr(at + words.size()));
    if (tokens.empty()) return {};
    return text.to_unsigned(tokens[0].substr(0, tokens[0].find(',')), "the number of images");
}

bool is_number(std::string_view token, bool whole) {
    if (token.starts_with('+') || token.starts_with('-')) token.remove_prefix(1);
    double value = 0;
    const auto [end, error] = std::from_chars(token.data(), token.data() + token.size(), value);
    return error == std::errc() && end == token.data() + token.size() && (!whole || value == std::floor(value));
}

/// X Y POINT3D_ID...
bool is_points_line(const std::vector<std::string_view>& tokens) {
    if (tokens.size() % 3 != 0) return false;
    for (size_t i = 0; i < tokens.size(); ++i)
        if (!is_number(tokens[i], i % 3 == 2)) return false;
    return true;
}

// Two lines per image: IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME, then its points X Y POINT3D_ID..., often empty.
void read_images_text(Images& images) {
    TextFile text(images.model.images_file, "list of images");
    std::optional<uint64_t> announced;
    for (std::string_view line; text.next_line(line);) {
        if (const auto count = announced_images(text, line)) announced = count;
        if (line.empty() || line.starts_with('#')) continue;
        const auto tokens = split_tokens(line);
        if (tokens.size() < 10) text.fail("expected IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME: correct the line");
        const uint64_t id = text.to_unsigned(tokens[0], "IMAGE_ID");
        std::array<double, 7> pose;
        constexpr const char* names[7] = {"QW", "QX", "QY", "QZ", "TX", "TY", "TZ"};
        for (size_t i = 0; i < 7; ++i) pose[i] = text.to_double(tokens[1 + i], names[i]);
        // A name may hold blanks: it is the rest of the line.
        std::string name(tokens[9].data(), line.data() + line.size());
        add_image(images, text.where(), id, name, text.to_unsigned(tokens[8], "CAMERA_ID"), pose);
        if (!text.next_line(line)) break;
        if (!is_points_line(split_tokens(line)))
            text.fail(
                fmt::format("expected the points X Y POINT3D_ID... of image '{}', or an empty line: every image "
                            "takes two lines, so put an empty one behind each that has no points",
                            name));
    }
    if (announced && *announced != images.model.images.size())
        throw UserError(
            fmt::format("{}: says that it holds {} images, but there are {}: correct the comment with the "
                        "number of images, or copy or write the model again",
                        images.model.images_file.string(), *announced, images.model.images.size()));
}

CameraList read_cameras_binary(const std::filesystem::path& path, Lenses lenses) {
    ColmapBinary file(path);
    CameraList cameras{lenses, {}};
    const auto count = file.get<uint64_t>();
    for (uint64_t i = 0; i < count; ++i) {
        file.set_entry(fmt::format("camera {} of {}", i + 1, count));
        const auto id = file.get<uint32_t>();
        const auto number = file.get<int32_t>();
        const auto width = file.get<uint64_t>(), height = file.get<uint64_t>();
        const std::string name = number >= 0 && number < static_cast<int32_t>(camera_models.size())
                                     ? camera_models[static_cast<size_t>(number)].name
                                     : fmt::format("number {}", number);
        const Model& model = find_model(path.string(), name);
        std::vector<double> parameters(parameter_count(model));
        for (double& p : parameters) p = file.get<double>();
        add_camera(cameras, path.string(), id, model, width, height, parameters);
    }
    file.expect_end();
    return cameras;
}

void read_images_binary(Images& images) {
    ColmapBinary file(images.model.images_file);
    const auto count = file.get<uint64_t>();
    for (uint64_t i = 0; i < count; ++i) {
        file.set_entry(fmt::format("image {} of {}", i + 1, count));
        const auto id = file.get<uint32_t>();
        std::array<double, 7> pose;
        for (double& p : pose) p = file.get<double>();
        const auto camera_id = file.get<uint32_t>();
        std::string name = file.get_string();
        file.skip(file.get<uint64_t>(), 24);  // points: x, y, POINT3D_ID
        add_image(images, images.model.images_file.string(), id, std::move(name), camera_id, pose);
    }
    file.expect_end();
}

}  // namespace

Calibration read_colmap(const std::filesystem::path& given, Lenses lenses) {
    const auto holds = [](const std::filesystem::path& folder, const char* ending) {
        return path_exists(folder / ("cameras" + std::string(ending))) &&
               path_exists(folder / ("images" + std::string(ending)));
    };
    const auto ending_in = [&](const std::filesystem::path& folder) {
        return std::string(holds(folder, ".bin") ? ".bin" : holds(folder, ".txt") ? ".txt" : "");
    };
    Calibration model;
    model.origin = "COLMAP";
    // The mapper writes a folder for each part that it can't join to the others: 0, and seldom 1, 2, ...
    const bool one_inside =
        ending_in(given).empty() && ending_in(given / "1").empty() && !ending_in(given / "0").empty();
    const std::filesystem::path folder = one_inside ? given / "0" : given;
    if (one_inside)
        model.remarks.push_back(fmt::format("{}: the model is taken from {}", given.string(), folder.string()));
    const std::string ending = ending_in(folder);
    if (ending.empty())
        throw UserError(
            fmt::format("{}: no COLMAP model here: {} takes the folder that holds cameras.bin and images.bin, or "
                        "cameras.txt and images.txt (COLMAP writes it as sparse or sparse/0)",
                        folder.string(), option_name("model")));
    model.cameras_file = folder / ("cameras" + ending);
    model.images_file = folder / ("images" + ending);
    const CameraList cameras = ending == ".bin" ? read_cameras_binary(model.cameras_file, lenses)
                                                : read_cameras_text(model.cameras_file, lenses);
    Images images{model, cameras};
    ending == ".bin" ? read_images_binary(images) : read_images_text(images);
    check_lengths(images);
    sort_images(model);
    const bool distorted =
        std::any_of(model.images.begin(), model.images.end(), [](const CalibratedImage& i) { return i.lens; });
    model.size_cure = distorted ? "give the photographs as they were taken, which this model calibrates"
                                : "give the undistorted files that belong to this model (`colmap image_undistorter` "
                                  "writes both)";
    return model;
}

}  // namespace radiafit::tools

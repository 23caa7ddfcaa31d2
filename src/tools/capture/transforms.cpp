#include "capture/transforms.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/error.h"
#include "base/json.h"
#include "base/read_file.h"
#include "base/wording.h"
#include "capture/image_finder.h"
#include "image/image_header.h"

namespace radiafit::tools {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;

/// A frame, which has what the file says of all frames unless it says otherwise.
class Frame {
public:
    Frame(const Json& frame, const Json& whole, std::string where)
        : levels_{&frame, &whole}, where_(std::move(where)) {}

    /// The first of `keys` that the frame has, else the first that the file has, with its key.
    std::optional<std::pair<const char*, double>> first_number(std::initializer_list<const char*> keys) const {
        for (const Json* level : levels_)
            for (const char* key : keys)
                if (const auto found = level->find(key); found != level->end() && !found->is_null())
                    return std::pair(key, number(*found, key));
        return {};
    }
    std::optional<double> optional_number(const char* key) const {
        const auto found = first_number({key});
        return found ? std::optional(found->second) : std::nullopt;
    }
    const Json* value(const char* key) const {
        for (const Json* level : levels_)
            if (const auto found = level->find(key); found != level->end() && !found->is_null()) return &*found;
        return nullptr;
    }
    double number(const Json& json, const char* key) const {
        if (!json.is_number()) fail(fmt::format("\"{}\" must be a number", key));
        return json.get<double>();  // JSON has no NaN and no infinity
    }
    const std::string& where() const { return where_; }
    [[noreturn]] void fail(const std::string& problem) const {
        throw UserError(fmt::format("{}: {}: write the file again", where_, problem));
    }

private:
    std::array<const Json*, 2> levels_;
    std::string where_;
};

/// What the frame calls its lens, and whether that is a fisheye.
struct LensKind {
    std::string name = "OPENCV";
    bool fisheye = false;
};

LensKind lens_kind(const Frame& frame) {
    LensKind kind;
    if (const Json* fisheye = frame.value("is_fisheye"); fisheye && *fisheye != false && *fisheye != 0)
        kind = {"OPENCV_FISHEYE", true};
    const Json* model = frame.value("camera_model");
    if (!model) return kind;
    constexpr const char* known[] = {"SIMPLE_PINHOLE", "PINHOLE", "PERSPECTIVE", "SIMPLE_RADIAL",
                                     "RADIAL",         "OPENCV",  "FULL_OPENCV"};
    constexpr const char* fisheyes[] = {"OPENCV_FISHEYE", "RADIAL_FISHEYE", "SIMPLE_RADIAL_FISHEYE", "FISHEYE"};
    if (!model->is_string()) frame.fail("\"camera_model\" must be a text");
    const auto name = model->get<std::string>();
    const auto is_in = [&](const auto& names) {
        return std::any_of(std::begin(names), std::end(names), [&](const char* k) { return name == k; });
    };
    if (is_in(fisheyes)) return {name, true};
    if (!is_in(known))
        throw UserError(
            fmt::format("{}: camera model {} is not read: undistort the photographs to pinholes with the program that "
                        "calibrated them, and give their cameras",
                        frame.where(), name));
    if (!kind.fisheye) kind.name = name;
    return kind;
}

/// The lens by k1 to k6, p1, p2, or nerfstudio's distortion_params, which are k1, k2, k3, k4, p1, p2.
/// A fisheye's k1 to k4 belong to the powers 2, 4, 6, 8 of the angle. Of other lenses k1 to k3 belong to those of the
/// radius; k4 is the eighth power's as nerfstudio has it, but with k5 or k6, which OpenCV alone has, or as FULL_OPENCV,
/// the first of a divisor.
std::optional<Lens> read_lens(const Frame& frame) {
    const LensKind kind = lens_kind(frame);
    constexpr std::array<const char*, 8> keys = {"k1", "k2", "k3", "k4", "k5", "k6", "p1", "p2"};
    std::array<double, 8> value{};
    if (const Json* list = frame.value("distortion_params")) {
        if (!list->is_array() || list->size() != 6) frame.fail("\"distortion_params\" must be 6 numbers");
        constexpr std::array<size_t, 6> places = {0, 1, 2, 3, 6, 7};
        for (size_t i = 0; i < 6; ++i) value[places[i]] = frame.number((*list)[i], "distortion_params");
    }
    for (size_t i = 0; i < keys.size(); ++i) value[i] = frame.optional_number(keys[i]).value_or(value[i]);
    const auto [k1, k2, k3, k4, k5, k6, p1, p2] = value;
    std::string text;
    for (size_t i = 0; i < keys.size(); ++i)
        if (value[i] != 0) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", keys[i], value[i]);
    LensCoefficients c;
    c.radial = {k1, k2, k3, k4};
    c.tangential = {p1, p2};
    if (kind.fisheye) {
        if (k5 != 0 || k6 != 0 || p1 != 0 || p2 != 0)
            frame.fail(fmt::format("a fisheye has k1 to k4 alone, not {}", text));
        c.bend = 1;
    } else if (kind.name == "FULL_OPENCV" || k5 != 0 || k6 != 0) {
        c.radial[3] = 0;
        c.divisor = {k4, k5, k6};
    }
    Lens lens(fmt::format("{} ({})", kind.name, text.empty() ? "no coefficients" : text), c);
    return lens.distorts() ? std::optional(std::move(lens)) : std::nullopt;
}

int side(const Frame& frame, const char* key, double value) {
    if (!(value >= 1 && value <= largest_calibrated_side) || value != std::floor(value))
        frame.fail(fmt::format("\"{}\" is {}, no whole number from 1 to {}", key, value, largest_calibrated_side));
    return static_cast<int>(value);
}

/// The size that the frame says, or else the photograph's, if that is there.
bool set_size(Camera& camera, const Frame& frame, const fs::path& photograph) {
    const auto width = frame.optional_number("w"), height = frame.optional_number("h");
    if (width && height) {
        camera.width = side(frame, "w", *width);
        camera.height = side(frame, "h", *height);
        return true;
    }
    if (photograph.empty()) return false;
    const ImageHeader header = read_image_header(photograph, read_file(photograph, "image file"));
    camera.width = static_cast<int>(header.width);
    camera.height = static_cast<int>(header.height);
    return true;
}

/// In pixels, along a side of `pixels`: `value` itself, or found from the angle that the side spans.
double focal_length(const Frame& frame, const char* key, double value, int pixels) {
    if (!std::string_view(key).starts_with("camera_angle")) {
        if (!(value > 0)) frame.fail(fmt::format("\"{}\" is {}, not positive", key, value));
        return value;
    }
    if (!(value > 0 && value < M_PI)) frame.fail(fmt::format("\"{}\" is {}, not between 0 and pi", key, value));
    return 0.5 * pixels / std::tan(0.5 * value);
}

void set_focal_lengths(Camera& camera, const Frame& frame) {
    const auto x = frame.first_number({"fl_x", "camera_angle_x"}), y = frame.first_number({"fl_y", "camera_angle_y"});
    if (!x) frame.fail("neither \"fl_x\" nor \"camera_angle_x\" is given");
    camera.fx = focal_length(frame, x->first, x->second, camera.width);
    camera.fy = y ? focal_length(frame, y->first, y->second, camera.height) : camera.fx;
    camera.cx = frame.optional_number("cx").value_or(0.5 * camera.width);
    camera.cy = frame.optional_number("cy").value_or(0.5 * camera.height);
    const auto is_share = [](double value) { return value > 0 && value < 1; };
    if (is_share(camera.cx) && is_share(camera.cy) && std::min(camera.width, camera.height) > 2)
        frame.fail(fmt::format("\"cx\" and \"cy\" are {:g} and {:g}, shares of the photograph where pixels belong",
                               camera.cx, camera.cy));
}

/// Reads the pose from 3 or 4 rows of transform_matrix.
void read_pose(Camera& camera, const Frame& frame, const Json& json) {
    const auto found = json.find("transform_matrix");
    constexpr const char* shape = "\"transform_matrix\" must be 4 rows of 4 numbers";
    if (found == json.end() || !found->is_array() || found->size() < 3 || found->size() > 4) frame.fail(shape);
    Eigen::Matrix4d pose = Eigen::Matrix4d::Identity();
    for (size_t row = 0; row < found->size(); ++row) {
        const Json& numbers = (*found)[row];
        if (!numbers.is_array() || numbers.size() != 4) frame.fail(shape);
        for (size_t column = 0; column < 4; ++column)
            pose(ptrdiff_t(row), ptrdiff_t(column)) = frame.number(numbers[column], "transform_matrix");
    }
    if (pose.row(3) != Eigen::RowVector4d(0, 0, 0, 1))
        frame.fail("the last row of \"transform_matrix\" is not 0, 0, 0, 1");
    Mat3d axes = pose.topLeftCorner<3, 3>();  // right, up, back
    axes.rightCols<2>() *= -1;
    set_pose(camera, axes, pose.topRightCorner<3, 1>(), frame.where());
}

/// nerfstudio's masks, by paths from the file's folder; empty: none.
fs::path find_mask(const Json& json, ImageFinder& masks, const fs::path& folder, const fs::path& photograph,
                   const Frame& frame) {
    const auto path = json.find("mask_path");
    if (path == json.end() || path->is_null()) return {};
    if (!path->is_string()) frame.fail("\"mask_path\" must be a text");
    const auto mask = masks.find(path->get<std::string>());
    std::error_code ignored;                                           // of what is no file, reading says so
    if (!mask || fs::equivalent(folder / *mask, photograph, ignored))  // which its own name may lead to
        throw UserError(fmt::format("{}: no such mask, but {} names it: restore it, or give {}",
                                    (folder / path->get<std::string>()).string(), frame.where(), option_name("masks")));
    return folder / *mask;
}

/// What finds the files that frames name.
struct Files {
    fs::path images, folder;  ///< of photographs; of the file itself
    ImageFinder photographs, masks;
};

CalibratedImage read_frame(const Json& json, const Json& whole, const fs::path& file, size_t index, Files& files) {
    const std::string where = fmt::format("{}: frames[{}]", file.string(), index);
    if (!json.is_object()) throw UserError(where + ": must be an object: write the file again");
    const auto path = json.find("file_path");
    if (path == json.end() || !path->is_string())
        throw UserError(where + ": \"file_path\" must be a text: write the file again");
    const Frame frame(json, whole, where);
    CalibratedImage image;
    image.lens = read_lens(frame);
    image.name = path->get<std::string>();
    if (!fs::path(image.name).has_filename()) frame.fail("\"file_path\" names no file");
    if (const auto photograph = files.photographs.find(image.name)) {
        image.name = photograph->generic_string();
        image.file = files.images / *photograph;
        image.mask = find_mask(json, files.masks, files.folder, image.file, frame);
    }
    if (!set_size(image.camera, frame, image.file)) return image;
    set_focal_lengths(image.camera, frame);
    read_pose(image.camera, frame, json);
    return image;
}

/// nerfstudio's applied_transform, 3 or 4 rows of 4, and applied_scale behind it: what took the frame of the
/// calibration before, COLMAP's mostly, to the file's.
std::optional<KnownTransform> read_applied_transform(const Json& whole, const fs::path& file) {
    const auto found = whole.find("applied_transform"), scale = whole.find("applied_scale");
    KnownTransform transform;
    const auto scaled = [&]() -> std::optional<KnownTransform> {
        if (scale != whole.end() && !scale->is_null()) {
            const double factor = scale->is_number() ? scale->get<double>() : 0;
            if (!(factor > 0 && std::isfinite(factor)))
                throw UserError(
                    fmt::format("{}: \"applied_scale\" must be a number above 0: write the file again", file.string()));
            transform.linear *= factor;
            transform.shift *= factor;
        }
        if (transform.linear.isIdentity(0) && transform.shift.isZero(0)) return {};
        transform.cure = "give " + option_name("apply-transform");
        return transform;
    };
    if (found == whole.end() || found->is_null()) return scaled();
    const auto fail = [&] {
        throw UserError(
            fmt::format("{}: \"applied_transform\" must be 3 rows of 4 numbers, a turn and a shift: write the "
                        "file again",
                        file.string()));
    };
    if (!found->is_array() || found->size() < 3 || found->size() > 4) fail();
    for (size_t row = 0; row < 3; ++row) {
        const Json& numbers = (*found)[row];
        if (!numbers.is_array() || numbers.size() != 4) fail();
        for (size_t column = 0; column < 4; ++column) {
            if (!numbers[column].is_number()) fail();
            (column < 3 ? transform.linear(ptrdiff_t(row), ptrdiff_t(column)) : transform.shift[ptrdiff_t(row)]) =
                numbers[column].get<double>();
        }
    }
    if (!(std::abs(transform.linear.determinant()) > 1e-12) || !transform.shift.allFinite()) fail();
    return scaled();
}

std::vector<CalibratedImage> read_frames(const fs::path& file, const fs::path& images, Calibration& calibration) {
    const std::string text = read_file(file, "file of cameras");
    if (nested_deeper(text, 100))
        throw UserError(
            fmt::format("{}: its brackets are nested more than 100 deep: write the file again", file.string()));
    const Json whole = parse_json<Json>(text);
    if (whole.is_discarded())
        throw UserError(
            fmt::format("{}: truncated, or no JSON (which has no NaN): copy or write the file again", file.string()));
    const auto frames = whole.is_object() ? whole.find("frames") : whole.end();
    if (frames == whole.end() || !frames->is_array())
        throw UserError(fmt::format("{}: has no list of \"frames\": give a NeRF's transforms.json", file.string()));
    const fs::path folder = file.parent_path();
    Files files{images, folder, {images, file}, {folder, file}};
    std::vector<CalibratedImage> result;
    for (size_t i = 0; i < frames->size(); ++i) result.push_back(read_frame((*frames)[i], whole, file, i, files));
    for (const ImageFinder* finder : {&files.photographs, &files.masks})
        for (std::string& remark : finder->remarks()) calibration.remarks.push_back(std::move(remark));
    if (!calibration.hints.known_transform) calibration.hints.known_transform = read_applied_transform(whole, file);
    return result;
}

/// For an image that is in both files. Another camera there would mean another photograph of the same name.
void hold_out(CalibratedImage& image, const CalibratedImage& test, const TransformsFiles& files) {
    const Camera &camera = image.camera, &in_test = test.camera;
    const auto near = [](double a, double b) { return std::abs(a - b) <= 1e-6 * std::max(1.0, std::abs(a)); };
    const bool same = image.lens == test.lens && camera.width == in_test.width && camera.height == in_test.height &&
                      near(camera.fx, in_test.fx) && near(camera.fy, in_test.fy) && near(camera.cx, in_test.cx) &&
                      near(camera.cy, in_test.cy) &&
                      camera.cam_from_world_rotation.isApprox(in_test.cam_from_world_rotation, 1e-6) &&
                      (camera.center() - in_test.center()).norm() <= 1e-6 * std::max(1.0, camera.center().norm());
    if (!same)
        throw UserError(fmt::format("{}: image '{}' has another camera here than in {}: check {}", files.test.string(),
                                    image.name, files.main.string(), option_name("images")));
    image.held_out = true;
}

}  // namespace

TransformsFiles find_transforms(const fs::path& model) {
    TransformsFiles files;
    if (!folder_exists(model)) {
        files.main = model;
    } else {
        for (const char* name : {"transforms.json", "transforms_train.json"})
            if (files.main.empty() && path_exists(model / name)) files.main = model / name;
        if (files.main.empty())
            throw UserError(fmt::format("{}: neither transforms.json nor transforms_train.json is here: check {}",
                                        model.string(), option_name("model")));
    }
    const fs::path test = files.main.parent_path() / "transforms_test.json";
    if (files.main.filename() != test.filename() && path_exists(test)) files.test = test;
    return files;
}

Calibration read_transforms(const TransformsFiles& files, const fs::path& images) {
    Calibration calibration;
    calibration.origin = files.main.filename().string();
    calibration.cameras_file = calibration.images_file = files.main;
    calibration.hints.poses = transforms_poses;
    calibration.size_cure = fmt::format("give the photographs that were calibrated, at that size ({} scales them down)",
                                        option_name("max-size"));
    calibration.images = read_frames(files.main, images, calibration);
    sort_images(calibration);
    if (files.test.empty()) return calibration;

    std::map<std::string, size_t> known;
    for (size_t i = 0; i < calibration.images.size(); ++i) known[calibration.images[i].name] = i;
    std::vector<CalibratedImage> test = read_frames(files.test, images, calibration);
    for (CalibratedImage& image : test) {
        image.held_out = true;
        const auto same = known.find(image.name);
        if (same == known.end())
            calibration.images.push_back(std::move(image));
        else
            hold_out(calibration.images[same->second], image, files);
    }
    sort_images(calibration);
    calibration.remarks.push_back(fmt::format("the {} images of {} are held out", test.size(), files.test.string()));
    return calibration;
}

}  // namespace radiafit::tools

// The same photographs with the same cameras, written as COLMAP, as a NeRF's transforms.json and as LLFF's
// poses_bounds.npy, become the same dataset; and what is wrong with such files is said in one line.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Geometry>
#include <cmath>
#include <nlohmann/json.hpp>
#include <random>

#include "capture/import.h"
#include "capture/llff.h"
#include "capture/transforms.h"
#include "capture_fixture.h"
#include "dataset/dataset.h"
#include "npy_bytes.h"

namespace radiafit {
using namespace tools;
namespace {

using namespace testing;
using Json = nlohmann::ordered_json;

class CalibrationsTest : public FolderTest {
protected:
    static constexpr int width = 64, height = 48, count = 6;
    static constexpr double focal_length = 70;

    /// Six cameras around a tetrahedron, rolled, at different distances.
    CalibrationsTest() {
        std::mt19937 random(7);
        std::uniform_real_distribution<double> uniform(-1, 1);
        for (int i = 0; i < count; ++i) {
            const Vec3d eye = (4 + 0.5 * uniform(random)) * Vec3d(uniform(random), uniform(random), 1.5).normalized();
            const Vec3d up(uniform(random), 2, uniform(random));
            cameras_.push_back(Camera::look_at(eye, 0.1 * Vec3d(uniform(random), uniform(random), uniform(random)), up,
                                               2 * std::atan(0.5 * height / focal_length), width, height));
            std::vector<uint16_t> pixels(size_t(width * height * 3)), mask(size_t(width * height));
            for (uint16_t& v : pixels) v = uint16_t(random() % 256);
            for (size_t p = 0; p < mask.size(); ++p) mask[p] = p % width > 10 ? 255 : 0;
            write_bytes(root_ / "images" / name(i), encode_png(width, height, 3, 8, pixels));
            write_bytes(root_ / "masks" / ("mask_" + name(i)), encode_png(width, height, 1, 8, mask));
        }
        write_bytes(root_ / "mesh.obj",
                    "v 1 1 1\nv 1 -1 -1\nv -1 1 -1\nv -1 -1 1\nf 1 2 3\nf 1 4 2\nf 1 3 4\nf 2 4 3\n");
        options_.mesh = root_ / "mesh.obj";
        options_.masks = root_ / "masks";
    }
    static std::string name(int i) { return fmt::format("{}.png", i); }

    /// Columns right, down, forward in the world, and the centre.
    static Eigen::Matrix<double, 3, 4> pose(const Camera& camera) {
        Eigen::Matrix<double, 3, 4> pose;
        pose << camera.cam_from_world_rotation.transpose(), camera.center();
        return pose;
    }
    void write_colmap() {
        std::string images;
        for (int i = 0; i < count; ++i) {
            const Camera& c = cameras_[size_t(i)];
            const Eigen::Quaterniond q(c.cam_from_world_rotation);
            const Vec3d& t = c.cam_from_world_translation;
            images += fmt::format("{} {} {} {} {} {} {} {} 1 {}\n\n", i + 1, q.w(), q.x(), q.y(), q.z(), t.x(), t.y(),
                                  t.z(), name(i));
        }
        write_bytes(root_ / "sparse/cameras.txt", fmt::format("1 PINHOLE {} {} {} {} {} {}\n", width, height,
                                                              focal_length, focal_length, 0.5 * width, 0.5 * height));
        write_bytes(root_ / "sparse/images.txt", images);
    }
    /// file_path as given by path(i).
    Json frame(int i, const std::string& path) const {
        Eigen::Matrix<double, 3, 4> p = pose(cameras_[size_t(i)]);
        p.middleCols<2>(1) *= -1;  // right, up, back
        Json matrix = Json::array();
        for (int row = 0; row < 3; ++row) matrix.push_back({p(row, 0), p(row, 1), p(row, 2), p(row, 3)});
        matrix.push_back({0.0, 0.0, 0.0, 1.0});
        return {{"file_path", path}, {"transform_matrix", matrix}};
    }
    Json transforms(const std::vector<int>& chosen, const std::string& ending = ".png") const {
        Json json = {{"fl_x", focal_length},
                     {"fl_y", focal_length},
                     {"cx", 0.5 * width},
                     {"cy", 0.5 * height},
                     {"w", width},
                     {"h", height},
                     {"k1", 0},
                     {"camera_model", "OPENCV"},
                     {"aabb_scale", 4},
                     {"frames", Json::array()}};
        for (const int i : chosen) json["frames"].push_back(frame(i, fmt::format("./images/{}{}", i, ending)));
        return json;
    }
    void write_transforms(const Json& json, const char* file = "transforms.json") {
        write_bytes(root_ / file, json.dump(1));
    }
    std::vector<double> llff_rows() const {
        std::vector<double> rows;
        for (const Camera& camera : cameras_) {
            const auto p = pose(camera);
            const double lens[3] = {height, width, focal_length};
            for (int row = 0; row < 3; ++row)
                rows.insert(rows.end(), {p(row, 1), p(row, 0), -p(row, 2), p(row, 3), lens[row]});
            rows.insert(rows.end(), {1.0, 10.0});
        }
        return rows;
    }
    void write_llff(const std::vector<double>& rows) {
        write_bytes(root_ / "poses_bounds.npy",
                    npy("<f8", false, fmt::format("({}, 17)", rows.size() / 17), bytes_of(rows)));
    }

    using Import = ImportReport (*)(const ImportOptions&, const fs::path&);
    Dataset import(Import importer, const fs::path& model, const std::string& out) {
        options_.model = root_ / model;
        fs::remove_all(root_ / out);
        report_ = importer(options_, root_ / out);
        return open_dataset(root_ / out);
    }
    std::string refused(Import importer, const fs::path& model) {
        options_.model = root_ / model;
        const std::string text = complaint([&] { importer(options_, root_ / "refused"); });
        EXPECT_FALSE(fs::exists(root_ / "refused"));
        return text;
    }
    static std::vector<std::string> held_out(const Dataset& set) {
        std::vector<std::string> names;
        for (const View& view : set.views)
            if (view.held_out) names.push_back(view.name);
        return names;
    }
    /// 1e-9 pixels or units: a few hundred roundings of doubles of some 100.
    static void expect_same_camera(const Camera& a, const Camera& b, double tolerance = 1e-9) {
        EXPECT_EQ(a.width, b.width);
        EXPECT_EQ(a.height, b.height);
        for (const auto member : {&Camera::fx, &Camera::fy, &Camera::cx, &Camera::cy})
            EXPECT_NEAR(a.*member, b.*member, tolerance);
        EXPECT_LT((a.cam_from_world_rotation - b.cam_from_world_rotation).cwiseAbs().maxCoeff(), tolerance);
        EXPECT_LT((a.cam_from_world_translation - b.cam_from_world_translation).cwiseAbs().maxCoeff(), tolerance);
    }
    void expect_same(const Dataset& a, const Dataset& b) const {
        ASSERT_EQ(a.views.size(), size_t(count));
        ASSERT_EQ(b.views.size(), size_t(count));
        EXPECT_EQ(a.mesh.positions, b.mesh.positions);
        EXPECT_EQ(a.mesh.triangles, b.mesh.triangles);
        for (size_t i = 0; i < a.views.size(); ++i) {
            SCOPED_TRACE(i);
            const View &x = a.views[i], &y = b.views[i];
            EXPECT_EQ(x.name, y.name);
            EXPECT_EQ(x.held_out, y.held_out);
            EXPECT_EQ(x.crop_origin, y.crop_origin);
            EXPECT_NEAR(x.gain[0], y.gain[0], 1e-6);
            expect_same_camera(x.camera, y.camera);
        }
        EXPECT_EQ(read_bytes(a.folder / "images.bin"), read_bytes(b.folder / "images.bin"));
    }

    std::vector<Camera> cameras_;
    ImportOptions options_;
    ImportReport report_;
};

TEST_F(CalibrationsTest, ThreeFormatsAreTheSameDataset) {
    write_colmap();
    write_transforms(transforms({0, 1, 2, 3, 4, 5}));
    write_llff(llff_rows());
    for (const int max_size : {0, 32}) {
        SCOPED_TRACE(max_size);
        options_.max_size = max_size;
        options_.holdout = "every:3+1";
        options_.gains = "estimate";
        options_.images = root_ / "images";
        const Dataset colmap = import(import_colmap, "sparse", "colmap");
        EXPECT_EQ(held_out(colmap), (std::vector<std::string>{"1.png", "4.png"}));
        // The cameras are those that were written: a point lands where it does, the crop and the scale apart.
        for (size_t i = 0; i < colmap.views.size(); ++i) {
            const View& view = colmap.views[i];
            const Vec3d at = view.camera.project({0.2, -0.3, 0.1}), full = cameras_[i].project({0.2, -0.3, 0.1});
            const double scale = double(view.full_size[0]) / width;
            EXPECT_NEAR(at.x() + view.crop_origin[0], scale * full.x(), 1e-9);
            EXPECT_NEAR(at.y() + view.crop_origin[1], scale * full.y(), 1e-9);
        }
        expect_same(import(import_transforms, "transforms.json", "transforms"), colmap);
        EXPECT_EQ(open_dataset(root_ / "transforms").source.find("radiafit import transforms --model "), 0u);
        expect_same(import(import_llff, "poses_bounds.npy", "llff"), colmap);
        EXPECT_EQ(open_dataset(root_ / "llff").source.find("radiafit import llff --model "), 0u);
    }
}

TEST_F(CalibrationsTest, FoldersAndDefaults) {
    write_llff(llff_rows());
    write_transforms(transforms({0, 1, 2, 3, 4, 5}));
    const Dataset llff = import(import_llff, "", "llff");
    EXPECT_EQ(held_out(llff), std::vector<std::string>{"0.png"});
    options_.masks = root_ / "masks";
    const Dataset set = import(import_transforms, "", "set");
    EXPECT_EQ(set.views[2].name, "images/2.png");
    EXPECT_EQ(held_out(set), std::vector<std::string>{"images/0.png"});
    EXPECT_EQ(read_bytes(set.folder / "images.bin"), read_bytes(llff.folder / "images.bin"));
    expect_in("masks are named mask_NAME.png, without subfolders", report_.remarks.at(0));
}

TEST_F(CalibrationsTest, MeshesInTheFrameBeforeAnAppliedTransform) {
    Json file = transforms({0, 1, 2, 3, 4, 5});
    file["applied_transform"] = {{1, 0, 0, 0.5}, {0, 0, 1, -1}, {0, -1, 0, 2}};
    write_transforms(file);
    const Dataset plain = import(import_transforms, "", "plain");
    bool said = false;
    for (const std::string& remark : report_.remarks)
        said = said || remark.find("applied_transform") != std::string::npos;
    EXPECT_TRUE(said);
    Mat3d linear;
    linear << 1, 0, 0, 0, 0, 1, 0, -1, 0;
    std::string obj;
    for (const Vec3f& q : plain.mesh.positions) {
        const Vec3d p = linear.transpose() * (q.cast<double>() - Vec3d(0.5, -1, 2));
        obj += fmt::format("v {} {} {}\n", p.x(), p.y(), p.z());
    }
    for (const auto& t : plain.mesh.triangles) obj += fmt::format("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
    options_.mesh = root_ / "before.obj";
    write_bytes(options_.mesh, obj);
    options_.apply_transform = true;
    const Dataset moved = import(import_transforms, "", "moved");
    ASSERT_EQ(moved.mesh.triangles, plain.mesh.triangles);
    for (size_t v = 0; v < plain.mesh.vertex_count(); ++v)
        EXPECT_LT((moved.mesh.positions[v] - plain.mesh.positions[v]).norm(), 1e-6f);
    // A scale that came behind it.
    file["applied_scale"] = 0.5;
    write_transforms(file);
    options_.least_coverage = 0;  // the cameras stay where they are
    const Dataset scaled = import(import_transforms, "", "scaled");
    options_.least_coverage = {};
    for (size_t v = 0; v < plain.mesh.vertex_count(); ++v)
        EXPECT_LT((scaled.mesh.positions[v] - 0.5f * plain.mesh.positions[v]).norm(), 1e-6f);
    for (const Json& bad : std::vector<Json>{0, -1, "2"}) {
        file["applied_scale"] = bad;
        write_transforms(file);
        expect_in("must be a number above 0", refused(import_transforms, ""));
    }
    file.erase("applied_scale");
    file.erase("applied_transform");
    write_transforms(file);
    expect_in("has no applied_transform", refused(import_transforms, ""));
    file["applied_transform"] = {1, 2, 3};
    write_transforms(file);
    expect_in("must be 3 rows of 4 numbers", refused(import_transforms, ""));
}

TEST_F(CalibrationsTest, LlffsListSaysWhichPhotographsHaveRows) {
    write_llff(llff_rows());
    const Dataset all = import(import_llff, "", "all");
    fs::copy(root_ / "images/0.png", root_ / "images/00_blurred.png");
    write_bytes(root_ / "images/._0.png", "hidden");
    expect_in("has 6 rows, but", refused(import_llff, ""));
    write_bytes(root_ / "view_imgs.txt", "5.png\n0.png\n1.png\n2.png\n4.png\n3.png");
    const Dataset listed = import(import_llff, "", "listed");
    EXPECT_EQ(read_bytes(listed.folder / "images.bin"), read_bytes(all.folder / "images.bin"));
    write_bytes(root_ / "view_imgs.txt", "5.png\n0.png\n");
    expect_in("view_imgs.txt names 2 images", refused(import_llff, ""));
}

TEST_F(CalibrationsTest, PhotographsThatAreGoneMayBeSkipped) {
    write_transforms(transforms({0, 1, 2, 3, 4, 5}));
    fs::remove(root_ / "images/3.png");
    const std::string text = refused(import_transforms, "");
    expect_in("3.png: no such image", text);
    expect_in("(1 of 6 images are missing)", text);
    options_.skip_missing = true;
    const Dataset set = import(import_transforms, "", "set");
    EXPECT_EQ(set.views.size(), 5u);
    expect_in("1 of the 6 images of", report_.notes.at(0));
    fs::remove_all(root_ / "images");
    fs::create_directories(root_ / "images");
    expect_in("nor is any other of its 6 images there", refused(import_transforms, ""));
}

TEST_F(CalibrationsTest, BlendersFilesHaveAnAngleAndNoEndings) {
    Json train = {{"camera_angle_x", 2 * std::atan(0.5 * width / focal_length)}, {"frames", Json::array()}},
         test = train;
    for (int i = 0; i < count; ++i) (i < 4 ? train : test)["frames"].push_back(frame(i, fmt::format("./images/{}", i)));
    write_transforms(train, "transforms_train.json");
    write_transforms(test, "transforms_test.json");
    const Dataset set = import(import_transforms, "", "set");
    EXPECT_EQ(held_out(set), (std::vector<std::string>{"images/4.png", "images/5.png"}));
    expect_in("the 2 images of " + (root_ / "transforms_test.json").string() + " are held out", report_.remarks.at(0));
    for (size_t i = 0; i < set.views.size(); ++i) {
        const Camera &found = set.views[i].camera, &known = cameras_[i];
        const auto& crop = set.views[i].crop_origin;
        expect_same_camera(found, known.cropped(crop[0], crop[1], found.width, found.height));
    }
    write_transforms(test, "transforms_val.json");
    import(import_transforms, "", "set");
    expect_in("transforms_val.json is not read", fmt::format("{}", fmt::join(report_.remarks, "; ")));
    fs::remove(root_ / "transforms_val.json");
    options_.holdout = "every:2";
    EXPECT_EQ(held_out(import(import_transforms, "transforms_train.json", "set")),
              (std::vector<std::string>{"images/0.png", "images/2.png"}));
    expect_in("transforms_test.json is not read: 'holdout' says what is held out", report_.remarks.at(0));
    options_.holdout = "none";
    EXPECT_TRUE(held_out(import(import_transforms, "transforms_test.json", "set")).empty());

    // An image of both is held out; one of another camera is another photograph.
    options_.holdout.clear();
    test["frames"].push_back(frame(1, "images/1.png"));
    write_transforms(test, "transforms_test.json");
    EXPECT_EQ(held_out(import(import_transforms, "", "set")),
              (std::vector<std::string>{"images/1.png", "images/4.png", "images/5.png"}));
    test["frames"][2] = frame(2, "images/1.png");
    write_transforms(test, "transforms_test.json");
    expect_in("image 'images/1.png' has another camera here than in", refused(import_transforms, ""));
    write_transforms(train, "transforms_test.json");
    expect_in("all its images are held out", refused(import_transforms, ""));
}

TEST_F(CalibrationsTest, AMiddleInSharesOfThePhotographIsRefused) {
    Json json = transforms({0, 1, 2, 3, 4, 5});
    json["cx"] = json["cy"] = 0.5;
    write_transforms(json);
    expect_in("\"cx\" and \"cy\" are 0.5 and 0.5, shares of the photograph where pixels belong",
              refused(import_transforms, ""));
}

TEST_F(CalibrationsTest, AFrameGoesBeforeItsFile) {
    Json json = transforms({0, 1, 2, 3, 4, 5});
    json["fl_x"] = 1;
    json.erase("fl_y");
    json["cx"] = 7;
    json["w"] = 9;
    json["k1"] = 0.5;
    for (Json& f : json["frames"])
        f.update({{"cx", 0.5 * width}, {"w", double(width)}, {"k1", 0.0}, {"camera_angle_x", 1.0}, {"fl_y", 71}});
    const double fx = 0.5 * width / std::tan(0.5);
    write_transforms(json);
    const Calibration calibration = read_transforms(find_transforms(root_), root_);
    for (int i = 0; i < count; ++i) {
        Camera known = cameras_[size_t(i)];
        known.fx = fx;
        known.fy = 71;
        expect_same_camera(calibration.images[size_t(i)].camera, known);
    }
}

TEST_F(CalibrationsTest, FramesMayNameTheirMasks) {
    write_transforms(transforms({0, 1, 2, 3, 4, 5}));
    const Dataset by_name = import(import_transforms, "", "by_name");
    Json json = transforms({0, 1, 2, 3, 4, 5});
    for (int i = 0; i < count; ++i) json["frames"][size_t(i)]["mask_path"] = "masks/mask_" + name(i);
    write_transforms(json);
    options_.masks.clear();
    const Dataset by_path = import(import_transforms, "", "by_path");
    expect_same(by_path, by_name);
    EXPECT_TRUE(by_path.views[0].mask_offset.has_value());
    json["frames"][2]["mask_path"] = "masks/2.png";
    write_transforms(json);
    expect_in("masks/2.png: no such mask, but", refused(import_transforms, ""));
}

TEST_F(CalibrationsTest, RoundedPosesAreRotationsAgain) {
    Json json = transforms({0, 1, 2, 3, 4, 5});
    for (Json& f : json["frames"])
        for (Json& row : f["transform_matrix"])
            for (Json& v : row) v = std::round(1e4 * v.get<double>()) / 1e4;
    write_transforms(json);
    const Calibration calibration = read_transforms(find_transforms(root_), root_);
    for (int i = 0; i < count; ++i) {
        const Mat3d& r = calibration.images[size_t(i)].camera.cam_from_world_rotation;
        EXPECT_LT((r * r.transpose() - Mat3d::Identity()).norm(), 1e-12);
        expect_same_camera(calibration.images[size_t(i)].camera, cameras_[size_t(i)], 1e-3);
    }
}

TEST_F(CalibrationsTest, BadTransformsNameFileAndFrame) {
    const Json good = transforms({0, 1, 2, 3, 4, 5});
    const auto expect = [&](const std::string& what, const std::function<void(Json&)>& change) {
        Json json = good;
        change(json);
        write_transforms(json);
        const std::string text = refused(import_transforms, "");
        expect_in("transforms.json", text);
        expect_in(what, text);
    };
    const auto in_frame = [](const char* key, const Json& value) {
        return [=](Json& json) { json["frames"][1][key] = value; };
    };
    expect("frames[0]: camera model EQUIRECTANGULAR is not read: undistort",
           [](Json& j) { j["camera_model"] = "EQUIRECTANGULAR"; });
    expect("frames[0]: a fisheye has k1 to k4 alone, not k1 0.1, p2 0.001", [](Json& j) {
        j["is_fisheye"] = true;
        j["k1"] = 0.1;
        j["p2"] = 1e-3;
    });
    expect("frames[1]: \"k2\" must be a number", in_frame("k2", "x"));
    expect("frames[1]: \"distortion_params\" must be 6 numbers", in_frame("distortion_params", {0.1, 0.2}));
    expect("folds the picture over", [](Json& j) { j["k1"] = -500; });
    expect("\"camera_model\" must be a text", [](Json& j) { j["camera_model"] = 1; });
    expect("has no list of \"frames\"", [](Json& j) { j.erase("frames"); });
    expect("holds no image", [](Json& j) { j["frames"].clear(); });
    expect("frames[0]: must be an object", [](Json& j) { j["frames"][0] = 1; });
    expect("frames[1]: \"file_path\" must be a text", in_frame("file_path", 7));
    expect("frames[1]: \"file_path\" names no file", in_frame("file_path", "images/"));
    expect("gone.png: no such image, but", in_frame("file_path", "images/gone.png"));
    expect("image 'images/0.png' is given twice", in_frame("file_path", "images/0"));
    expect("frames[1]: \"transform_matrix\" must be 4 rows of 4 numbers", in_frame("transform_matrix", {1, 2, 3}));
    expect("must be 4 rows", [](Json& j) { j["frames"][1].erase("transform_matrix"); });
    expect("\"transform_matrix\" must be a number",
           [](Json& j) { j["frames"][1]["transform_matrix"][0][3] = nullptr; });
    expect("the last row", [](Json& j) { j["frames"][1]["transform_matrix"][3][0] = 0.5; });
    expect("no rotation", [](Json& j) { j["frames"][1]["transform_matrix"][0][0] = 5; });
    expect("no rotation (left-handed)", [](Json& j) {
        for (int row = 0; row < 3; ++row) {
            Json& v = j["frames"][1]["transform_matrix"][size_t(row)][0];
            v = -v.get<double>();
        }
    });
    expect("translation", [](Json& j) { j["frames"][1]["transform_matrix"][0][3] = 1e300; });
    expect("neither \"fl_x\" nor \"camera_angle_x\" is given", [](Json& j) { j.erase("fl_x"); });
    expect("\"fl_x\" must be a number", in_frame("fl_x", "60"));
    expect("\"fl_x\" is -60, not positive", in_frame("fl_x", -60));
    expect("\"camera_angle_y\" is 4, not between 0 and pi", [](Json& j) {
        j.erase("fl_y");
        j["camera_angle_y"] = 4;
    });
    expect("\"w\" is 64.5, no whole number from 1 to 65536", in_frame("w", 64.5));
    expect("\"h\" is 0, no whole number", in_frame("h", 0));
    expect("64 x 48 pixels, but", in_frame("w", 63));
    write_bytes(root_ / "transforms.json", good.dump().substr(0, 500));
    expect_in("truncated, or no JSON", refused(import_transforms, ""));
    write_bytes(root_ / "transforms.json", std::string(1000, '['));
    expect_in("nested more than 100 deep", refused(import_transforms, ""));
    write_transforms(transforms({0, 1, 2, 3, 4, 5}, ""));
    fs::copy(root_ / "images/3.png", root_ / "images/3.JPG");
    expect_in("take one away", refused(import_transforms, ""));
    fs::remove(root_ / "transforms.json");
    expect_in("neither transforms.json nor transforms_train.json", refused(import_transforms, ""));
    expect_in("no such file of cameras", refused(import_transforms, "transforms.json"));
}

TEST_F(CalibrationsTest, BadPosesNameFileAndRow) {
    const std::vector<double> good = llff_rows();
    const auto expect = [&](const std::string& what, size_t at, double value) {
        std::vector<double> rows = good;
        rows[at] = value;
        write_llff(rows);
        const std::string text = refused(import_llff, "");
        expect_in("poses_bounds.npy: row " + std::to_string(at / 17), text);
        expect_in(what, text);
    };
    expect("the height is 48.5, no whole number", 17 + 4, 48.5);
    expect("the width is nan, no whole number", 9, NAN);
    expect("focal lengths", 14, -3);
    expect("the pose is not finite", 34 + 3, INFINITY);
    expect("no rotation", 34, 3);
    std::vector<double> rows = good;
    rows[4] = 96;
    write_llff(rows);
    expect_in("calibrates 64 x 96: give the photographs that were calibrated, at that size", refused(import_llff, ""));
    rows.resize(34);
    write_llff(rows);
    expect_in("has 2 rows, but " + (root_ / "images").string() + " holds 6 images", refused(import_llff, ""));
    options_.images = root_ / "nowhere";
    expect_in("no such folder of photographs: check 'images'", refused(import_llff, ""));
}

}  // namespace
}  // namespace radiafit

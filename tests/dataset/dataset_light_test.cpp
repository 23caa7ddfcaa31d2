// Datasets of reflectance models: a light per image, normals finer than the mesh's, and grids of texels.
#include <array>
#include <cmath>

#include "dataset/dataset.h"
#include "dataset_fixture.h"

namespace radiafit {
namespace {

/// A dataset that the test can write again and again.
class WrittenTest : public DatasetTest {
protected:
    virtual void write() const = 0;
    /// What the reader says once the first `from` of dataset.json is replaced.
    std::string open_with(const std::string& from, const std::string& to) const {
        write();
        const fs::path json = folder_ / "dataset.json";
        write_text(json, replaced(read_text(json), from, to));
        return open();
    }
    /// What the reader says of the folder as it is.
    std::string open() const {
        return complaint([&] { open_dataset(folder_); });
    }

    const fs::path folder_ = root_ / "set";
    Dataset header_;
};

/// A dataset of two views under a light each, with a normal per texel.
class LitTest : public WrittenTest {
protected:
    static constexpr int side = 3;
    LitTest() {
        header_.name = "lit";
        header_.mesh = tetrahedron();
        Rng rng(3);
        header_.normal_map.side = side;
        for (int i = 0; i < 4 * side * (side + 1) / 2; ++i)
            header_.normal_map.normals.push_back(
                Vec3f(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1) + 2).normalized());
        lights_[0] = {Light::Kind::distant, Vec3d(1, 2, 3).normalized(), {0.1, 0.7, 1.5}};
        lights_[1] = {Light::Kind::near, {0.3, -4, 1.0 / 3}, {0, 20, 1}};
    }
    static View view(std::optional<Light> light) {
        View v;
        v.name = "one";
        v.camera = Camera::look_at({3, 1, 4}, {0, 0, 0}, {0, 0, 1}, 0.7, 4, 4);
        v.light = std::move(light);
        return v;
    }
    void write() const override {
        DatasetWriter writer(folder_);
        for (const Light& light : lights_) writer.add(view(light), std::vector<uint8_t>(48).data(), {});
        writer.finish(header_);
    }

    std::array<Light, 2> lights_;
};

TEST_F(LitTest, LightsAndNormalsSurviveExactly) {
    write();
    const Dataset dataset = open_dataset(folder_);
    ASSERT_TRUE(dataset.light_moves());
    for (size_t i = 0; i < 2; ++i) {
        EXPECT_EQ(dataset.views[i].light->kind, lights_[i].kind);
        EXPECT_EQ(dataset.views[i].light->place, lights_[i].place);
        EXPECT_EQ(dataset.views[i].light->intensity, lights_[i].intensity);
    }
    EXPECT_EQ(dataset.normal_map.normals, header_.normal_map.normals);
    const TriangleAtlas atlas = reflectance_atlas(dataset, side);
    for (uint32_t t = 0; t < atlas.texel_count(); ++t) EXPECT_EQ(atlas.normal(t), header_.normal_map.normals[t]);
    expect_in("'surface_side' 3", complaint([&] { reflectance_atlas(dataset, 4); }));
    write();  // an earlier one is replaced, normals and all
}

TEST_F(LitTest, WithoutLightsAndNormalsTheMeshHasItsOwn) {
    write_random(folder_, Encoding::u16_linear, {{4, 4, false, 1}});
    const Dataset dataset = open_dataset(folder_);
    EXPECT_FALSE(dataset.light_moves());
    EXPECT_EQ(dataset.normal_map.side, 0);
    const TriangleAtlas plain(dataset.mesh, 5), atlas = reflectance_atlas(dataset, 5);
    for (uint32_t t = 0; t < atlas.texel_count(); ++t) EXPECT_EQ(atlas.normal(t), plain.normal(t));
}

TEST_F(LitTest, WriterRefusesLightsThatAreNone) {
    DatasetWriter writer(folder_);
    const std::vector<uint8_t> pixels(48);
    const auto refused = [&](const Light& light) {
        return complaint([&] { writer.add(view(light), pixels.data(), {}); });
    };
    expect_in("unit vector", refused({Light::Kind::distant, Vec3d::Zero(), Vec3d::Ones()}));
    expect_in("has length nan", refused({Light::Kind::near, Vec3d(NAN, 0, 0), Vec3d::Ones()}));
    expect_in("has length 1e+13", refused({Light::Kind::near, Vec3d(0, 1e13, 0), Vec3d::Ones()}));
    expect_in("intensity is nan", refused({Light::Kind::near, Vec3d::Zero(), Vec3d(1, NAN, 1)}));
    expect_in("intensity is 1e+13", refused({Light::Kind::near, Vec3d::Zero(), Vec3d(1, 1e13, 1)}));
    expect_in("intensity", refused({Light::Kind::near, Vec3d::Zero(), Vec3d(1, -1, 1)}));
    expect_in("intensity", refused({Light::Kind::near, Vec3d::Zero(), Vec3d::Zero()}));
    writer.add(view(lights_[0]), pixels.data(), {});
    expect_in("all images", complaint([&] { writer.add(view(std::nullopt), pixels.data(), {}); }));
}

TEST_F(LitTest, ReaderRefusesWhatDoesNotFit) {
    expect_in("unit vector", open_with("\"direction\":[0.2", "\"direction\":[9.2"));
    expect_in("all must have one", open_with("\"light\":", "\"dark\":"));
    expect_in("views[0].light", open_with("\"direction\":", "\"diction\":"));
    expect_in("views[0].light.intensity", open_with("\"intensity\":[0.1,0.7,1.5]", "\"intensity\":[0.1,0.7]"));
    expect_in("intensity", open_with("\"intensity\":[0.1", "\"intensity\":[-0.1"));
    expect_in("normals.f32", open_with("{\"side\":3}", "{\"side\":4}"));
    expect_in("normals.side", open_with("{\"side\":3}", "{\"side\":0}"));
    write();
    {
        std::fstream file(folder_ / "normals.f32", std::ios::binary | std::ios::in | std::ios::out);
        const float nan = NAN;
        file.seekp(12 * 5).write(reinterpret_cast<const char*>(&nan), 4);
    }
    expect_in("normal 5 ", open());
    fs::remove(folder_ / "normals.f32");
    expect_in("normals.f32", open());
}

/// A tilted grid of 5 x 3 texels, seen by a near camera and by one far away, each under its light.
class GridTest : public WrittenTest {
protected:
    static constexpr int width = 5, height = 3;
    GridTest() {
        header_.name = "grid";
        header_.grid = Grid::centered(width, height, 0.1);
        const Mat3d turn = Camera::look_at({1, 2, 3}, {0, 0, 0}, {0, 0, 1}, 1, 1, 1).cam_from_world_rotation;
        for (Vec3d* v : {&header_.grid.origin, &header_.grid.right, &header_.grid.down}) *v = turn * *v;
        Rng rng(4);
        for (int i = 0; i < width * height; ++i)
            header_.grid.texel_normals.push_back(Vec3f(rng.uniform(-1, 1), rng.uniform(-1, 1), 2).normalized());
        header_.grid.texel_normals[7] = Vec3f::Zero();
    }
    Vec3d eye() const { return header_.grid.origin + 2 * header_.grid.normal() + 3 * header_.grid.right; }
    void write() const override {
        DatasetWriter writer(folder_);
        View view;
        view.name = "near";
        view.camera = header_.grid.camera_at(eye(), "near");
        view.light = Light{Light::Kind::near, eye(), Vec3d::Constant(4)};
        writer.add(view, std::vector<uint8_t>(3 * width * height).data(), {});
        view.name = "distant";
        view.camera = {};
        view.camera.width = width;
        view.camera.height = height;
        view.camera_direction = Vec3d(0.6, 0, 0.8);
        view.light = Light{Light::Kind::distant, Vec3d::UnitZ(), Vec3d::Ones()};
        writer.add(view, std::vector<uint8_t>(3 * width * height, 9).data(), std::vector<uint8_t>(width * height, 1));
        writer.finish(header_);
    }
};

TEST_F(GridTest, SurvivesExactly) {
    write();
    const Dataset dataset = open_dataset(folder_);
    const Grid &grid = dataset.grid, &wrote = header_.grid;
    ASSERT_TRUE(dataset.has_grid());
    EXPECT_EQ(grid.width, width);
    EXPECT_EQ(grid.height, height);
    EXPECT_EQ(grid.origin, wrote.origin);
    EXPECT_EQ(grid.right, wrote.right);
    EXPECT_EQ(grid.down, wrote.down);
    EXPECT_EQ(grid.texel_normals, wrote.texel_normals);
    EXPECT_EQ(dataset.views[1].camera_direction, Vec3d(0.6, 0, 0.8));
    EXPECT_FALSE(dataset.views[0].camera_direction);
    EXPECT_FALSE(fs::exists(folder_ / "mesh.ply"));
    expect_in("reflectance", complaint([&] { require_light_field(dataset); }));

    const GridAtlas atlas = make_atlas(grid);
    const GridAtlas plain = make_atlas({width, height, grid.origin, grid.right, grid.down, {}});
    for (uint32_t t = 0; t < atlas.texel_count(); ++t) {
        const int x = int(t) % width, y = int(t) / width;
        EXPECT_EQ(atlas.position(t), grid.position(x, y).cast<float>());
        EXPECT_EQ(atlas.usable(t), t != 7);
        EXPECT_EQ(atlas.normal(t), t != 7 ? wrote.texel_normals[t] : Vec3f(grid.normal().cast<float>()));
        EXPECT_TRUE(plain.usable(t));
        EXPECT_EQ(plain.normal(t), Vec3f(grid.normal().cast<float>()));
    }
    // An earlier grid is replaced, and so are its normals.
    Dataset bare = header_;
    bare.grid.texel_normals.clear();
    std::swap(header_, bare);
    write();
    EXPECT_FALSE(fs::exists(folder_ / "normals.f32"));
    EXPECT_TRUE(open_dataset(folder_).grid.texel_normals.empty());
}

TEST_F(GridTest, ANearCameraSeesTexelsAtTheirPixels) {
    write();
    const Dataset dataset = open_dataset(folder_);
    const View &near = dataset.views[0], &distant = dataset.views[1];
    EXPECT_LT((near.camera.center() - eye()).norm(), 1e-12);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const Vec3d p = dataset.grid.position(x, y), pixel = near.camera.project(p);
            EXPECT_NEAR(pixel.x(), x + 0.5, 1e-9);
            EXPECT_NEAR(pixel.y(), y + 0.5, 1e-9);
            EXPECT_NEAR(pixel.z(), 2, 1e-12);
            EXPECT_LT((near.direction_to_camera(p) - (eye() - p).normalized()).norm(), 1e-12);
            EXPECT_EQ(distant.direction_to_camera(p), Vec3d(0.6, 0, 0.8));
        }
    const Grid& grid = dataset.grid;
    expect_in("in front of", complaint([&] { (void)grid.camera_at(grid.origin - grid.normal(), "view"); }));
}

TEST_F(GridTest, CenteredIsCentredAndLooksUp) {
    const Grid grid = Grid::centered(4, 3, 0.5);
    EXPECT_EQ(grid.position(0, 0), Vec3d(-0.75, 0.5, 0));
    EXPECT_EQ(grid.position(3, 2), Vec3d(0.75, -0.5, 0));
    EXPECT_EQ(grid.normal(), Vec3d(0, 0, 1));
}

TEST_F(GridTest, ReaderRefusesWhatDoesNotFit) {
    expect_in("view \"near\" has 5 x 3 pixels", open_with("\"grid\": {\"width\":5", "\"grid\": {\"width\":6"));
    expect_in("grid.right", open_with("\"right\":", "\"left\":"));
    expect_in("right angles", open_with("\"down\":[", "\"down\":[1e3,0,0],\"was\":["));
    expect_in("unit vector", open_with("\"direction\":[0.6", "\"direction\":[0.7"));
    expect_in("only a grid", open_with("\"grid\":", "\"grit\":"));
    write();
    fs::resize_file(folder_ / "normals.f32", 12 * width * height - 12);
    expect_in("has 168 bytes, but 5 x 3 texels need 12 each", open());
}

}  // namespace
}  // namespace radiafit

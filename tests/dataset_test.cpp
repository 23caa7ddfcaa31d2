#include "dataset/dataset.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <csignal>
#include <cstring>
#include <fstream>
#include <functional>
#include <limits>
#include <sstream>

#include "base/error.h"
#include "base/half.h"
#include "base/rng.h"
#include "dataset/dataset_json.h"
#include "dataset/image_stream.h"
#include "dataset/mesh_ply.h"

namespace radiafit {
namespace {
namespace fs = std::filesystem;

/// A folder of this test's own, removed afterwards.
class DatasetTest : public testing::Test {
protected:
    DatasetTest() {
        const auto* info = testing::UnitTest::GetInstance()->current_test_info();
        std::string name = std::string("radiafit-") + info->name() + "-" + std::to_string(getpid());
        std::replace(name.begin(), name.end(), '/', '-');
        root_ = fs::temp_directory_path() / name;
        fs::remove_all(root_);
        fs::create_directories(root_);
    }
    ~DatasetTest() override {
        std::error_code ignored;
        fs::permissions(root_, fs::perms::owner_all, ignored);
        fs::remove_all(root_, ignored);
    }
    size_t entries() const { return size_t(std::distance(fs::directory_iterator(root_), fs::directory_iterator())); }

    fs::path root_;
};

/// The one line of the UserError that `body` throws.
std::string complaint(const std::function<void()>& body) {
    try {
        body();
    } catch (const UserError& error) {
        const std::string text = error.what();
        EXPECT_EQ(text.find('\n'), std::string::npos) << text;
        return text;
    }
    ADD_FAILURE() << "no UserError was thrown";
    return "";
}

void expect_in(const std::string& part, const std::string& text) {
    EXPECT_NE(text.find(part), std::string::npos) << "\"" << part << "\" is not in: " << text;
}

std::string read_text(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    std::ostringstream out;
    out << in.rdbuf();
    return out.str();
}

void write_text(const fs::path& file, const std::string& text) { std::ofstream(file, std::ios::binary) << text; }

Mesh tetrahedron() {
    Mesh mesh;
    mesh.positions = {{1, 1, 1}, {-1, -1, 1}, {-1, 1, -1}, {1, -1, -1.25f}};
    mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
    return mesh;
}

/// What a dataset should give back: stored channels as double, masks as given.
struct Truth {
    Dataset header;
    std::vector<std::vector<double>> stored;  ///< [view][pixel * 3 + channel]
    std::vector<std::vector<uint8_t>> masks;  ///< [view][pixel], empty: none
};

struct Shape {
    int width, height;
    bool mask;
    double gain;
};

/// Writes random images; every value of an 8-bit encoding occurs.
Truth write_random(const fs::path& folder, Encoding encoding, const std::vector<Shape>& shapes) {
    Truth truth;
    Rng rng(7);
    DatasetWriter writer(folder);
    writer.set_encoding(encoding);
    for (size_t i = 0; i < shapes.size(); ++i) {
        const auto& [width, height, masked, gain] = shapes[i];
        View view;
        view.name = "view \"" + std::to_string(i) + "\"";
        view.camera = Camera::look_at({3, 1, 4.0 + double(i)}, {0, 0, 0}, {0, 0, 1}, 0.7, width, height);
        view.held_out = i % 2 == 1;
        view.gain = gain;
        view.crop_origin = {int(i), 2};
        view.full_size = {width + 5, height + 7};
        const size_t pixels = size_t(width) * size_t(height);
        std::vector<double> values(3 * pixels);
        std::vector<uint8_t> bytes(values.size() * size_t(bytes_per_channel(encoding)));
        for (size_t k = 0; k < values.size(); ++k) {
            uint16_t word = 0;
            if (encoding == Encoding::f16_linear) {
                word = half_from_float(rng.uniform(-0.5f, 3.0f));
                values[k] = double(float_from_half(word));
            } else if (encoding == Encoding::f32_linear) {
                const float value = rng.uniform(-0.5f, 3.0f);
                std::memcpy(bytes.data() + 4 * k, &value, 4);
                values[k] = double(value);
                continue;
            } else if (encoding == Encoding::u16_linear) {
                word = uint16_t(rng.index(65536));
                values[k] = word / 65535.0;
            } else {
                word = uint16_t(k < 256 ? k : rng.index(256));
                values[k] = word / 255.0;
            }
            std::memcpy(bytes.data() + k * size_t(bytes_per_channel(encoding)), &word,
                        size_t(bytes_per_channel(encoding)));
        }
        std::vector<uint8_t> mask(masked ? pixels : 0);
        for (uint8_t& m : mask) m = uint8_t(rng.index(2) * 200);
        writer.add(view, bytes.data(), mask);
        truth.header.views.push_back(view);
        truth.stored.push_back(values);
        truth.masks.push_back(mask);
    }
    truth.header.name = "random";
    truth.header.description = "Noise, in \"quotes\" and with ü.";
    truth.header.source = "a test";
    truth.header.mesh = tetrahedron();
    writer.finish(truth.header);
    return truth;
}

double reference_decode(double x) { return x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4); }
double reference_encode(double x) { return x <= 0.0031308 ? x * 12.92 : 1.055 * std::pow(x, 1 / 2.4) - 0.055; }

/// The target by the words of image_stream.h, in double.
double reference_target(Encoding encoding, TargetSpace space, double gain, double stored) {
    if (encoding != Encoding::u8_srgb) return gain * stored;
    const double light = gain * reference_decode(stored);
    return space == TargetSpace::linear ? light : reference_encode(light);
}

struct EncodingCase {
    Encoding encoding;
    TargetSpace space;
    StreamSource source;
    bool gains;
};

class EncodingTest : public DatasetTest, public testing::WithParamInterface<EncodingCase> {};

TEST_P(EncodingTest, RoundTrip) {
    const auto [encoding, space, source, gains] = GetParam();
    // Widths around the mask's bytes, the vector width and a page; with and without a mask; taller and wider.
    const std::vector<Shape> shapes = {{1, 1, true, 1},
                                       {7, 90, true, gains ? 1.7 : 1},
                                       {8, 61, false, gains ? 0.6 : 1},
                                       {13, 41, true, gains ? 1.7 : 1},
                                       {641, 3, true, 1}};
    const fs::path folder = root_ / "set";
    const Truth truth = write_random(folder, encoding, shapes);
    const Dataset dataset = open_dataset(folder);
    EXPECT_EQ(dataset.name, truth.header.name);
    EXPECT_EQ(dataset.description, truth.header.description);
    EXPECT_EQ(dataset.source, truth.header.source);
    EXPECT_EQ(dataset.encoding, encoding);
    EXPECT_EQ(dataset.mesh.positions, truth.header.mesh.positions);
    EXPECT_EQ(dataset.mesh.triangles, truth.header.mesh.triangles);
    EXPECT_EQ(dataset.split(true), (std::vector<uint32_t>{1, 3}));
    EXPECT_EQ(dataset.split(false), (std::vector<uint32_t>{0, 2, 4}));
    ASSERT_EQ(dataset.views.size(), shapes.size());
    uint64_t raw_bytes = 0;
    for (const Shape& s : shapes) raw_bytes += uint64_t(s.width * s.height * 3 * bytes_per_channel(encoding));
    EXPECT_EQ(dataset.image_bytes(), raw_bytes);

    ImageStream first(dataset, source, space);
    ImageStream second = first.another();
    const bool as_bytes =
        !gains && (encoding == Encoding::u8_linear || (encoding == Encoding::u8_srgb && space == TargetSpace::stored));
    EXPECT_EQ(first.bits(), as_bytes ? 8 : 16);
    double largest = 0;
    for (size_t i = 0; i < shapes.size(); ++i)
        for (const double v : truth.stored[i])
            largest = std::max(largest, reference_target(encoding, space, shapes[i].gain, v));
    // Integer encodings reserve room for their full range; random halves and floats are measured.
    const double full = reference_target(encoding, space, gains ? 1.7 : 1, 1);
    const bool measured = encoding == Encoding::f16_linear || encoding == Encoding::f32_linear;
    const double scale = as_bytes ? 1 / 255.0 : (measured ? largest : full) / 65535;
    EXPECT_NEAR(first.scale(), scale, scale * 1e-6);  // float against double

    TargetImage image;
    for (ImageStream* stream : {&first, &second, &first})  // a reused buffer must not remember the last image
        for (uint32_t i = 0; i < shapes.size(); ++i) {
            stream->load(i, image);
            ASSERT_EQ(image.width, shapes[i].width);
            ASSERT_EQ(image.height, shapes[i].height);
            const size_t pixels = size_t(image.width) * size_t(image.height);
            ASSERT_EQ(as_bytes ? image.rgba8.size() : image.rgba16.size(), 4 * pixels);
            EXPECT_EQ(as_bytes ? image.rgba16.size() : image.rgba8.size(), 0u);
            const double unit = double(image.scale16());
            for (size_t p = 0; p < pixels; ++p) {
                const auto rgba = image.channel16(p);
                for (size_t c = 0; c < 3; ++c) {
                    const double target =
                        std::max(0.0, reference_target(encoding, space, shapes[i].gain, truth.stored[i][3 * p + c]));
                    // Bytes are exact (to the float scale); 16 bits round to nearest, in float arithmetic.
                    const double tolerance = as_bytes ? 1e-6 : 0.52 * unit;
                    ASSERT_NEAR(rgba[c] * unit, target, tolerance)
                        << "view " << i << " pixel " << p << " channel " << c;
                }
                const bool inside = truth.masks[i].empty() || truth.masks[i][p] != 0;
                ASSERT_EQ(rgba[3], inside ? 65535 : 0) << "view " << i << " pixel " << p;
                ASSERT_EQ(image.masked_in(p), inside);
            }
        }
    std::vector<float> values;
    ImageStream exact(dataset, source, space);
    for (uint32_t i = 0; i < shapes.size(); ++i) {
        exact.load_values(i, values);
        ASSERT_EQ(values.size(), truth.stored[i].size());
        for (size_t k = 0; k < values.size(); ++k) {
            const double target = reference_target(encoding, space, shapes[i].gain, truth.stored[i][k]);
            ASSERT_NEAR(values[k], target, 2e-7 * (1 + std::abs(target)));  // rounded to float once
        }
    }
    EXPECT_GT(first.seconds(), 0);
    if (source == StreamSource::disk) {
        uint64_t once = raw_bytes;
        for (const Shape& s : shapes) once += s.mask ? uint64_t((s.width + 7) / 8 * s.height) : 0;
        EXPECT_EQ(first.bytes_read(), 2 * once);
    }
}

std::vector<EncodingCase> all_cases() {
    std::vector<EncodingCase> cases;
    for (const Encoding e :
         {Encoding::u8_srgb, Encoding::u8_linear, Encoding::u16_linear, Encoding::f16_linear, Encoding::f32_linear})
        for (const TargetSpace space : {TargetSpace::stored, TargetSpace::linear})
            for (const StreamSource source : {StreamSource::disk, StreamSource::memory})
                for (const bool gains : {false, true}) cases.push_back({e, space, source, gains});
    return cases;
}

INSTANTIATE_TEST_SUITE_P(All, EncodingTest, testing::ValuesIn(all_cases()), [](const auto& info) {
    const EncodingCase& c = info.param;
    std::string name = to_string(c.encoding) + (c.space == TargetSpace::linear ? "_linear" : "_stored") +
                       (c.source == StreamSource::disk ? "_disk" : "_memory") + (c.gains ? "_gains" : "");
    std::replace(name.begin(), name.end(), '-', '_');
    return name;
});

TEST_F(DatasetTest, CamerasAndInformationSurviveExactly) {
    const Truth truth = write_random(root_ / "set", Encoding::u8_srgb, {{9, 4, true, 1.1}, {5, 6, false, 1}});
    const Dataset dataset = open_dataset(root_ / "set");
    for (size_t i = 0; i < truth.header.views.size(); ++i) {
        const View& read = dataset.views[i];
        const View& written = truth.header.views[i];
        EXPECT_EQ(read.name, written.name);
        EXPECT_EQ(read.gain, written.gain);
        EXPECT_EQ(read.crop_origin, written.crop_origin);
        EXPECT_EQ(read.full_size, written.full_size);
        EXPECT_EQ(read.camera.fx, written.camera.fx);
        EXPECT_EQ(read.camera.fy, written.camera.fy);
        EXPECT_EQ(read.camera.cx, written.camera.cx);
        EXPECT_EQ(read.camera.cy, written.camera.cy);
        EXPECT_EQ(read.camera.cam_from_world_rotation, written.camera.cam_from_world_rotation);
        EXPECT_EQ(read.camera.cam_from_world_translation, written.camera.cam_from_world_translation);
        EXPECT_EQ(read.pixel_offset % 4096, 0u);
    }
}

TEST(Transfer, MatchesTheStandardAndInverts) {
    // IEC 61966-2-1: the two branches meet, and mid-grey 0.5 is 0.2140 linear.
    EXPECT_NEAR(srgb_decode(0.5), 0.21404, 1e-5);
    EXPECT_NEAR(srgb_decode(0.04045), srgb_decode(0.04045 + 1e-9), 1e-6);
    for (double x = -1.5; x <= 2; x += 0.01) EXPECT_NEAR(srgb_decode(srgb_encode(x)), x, 1e-7) << x;
    EXPECT_EQ(srgb_encode(-0.3), -srgb_encode(0.3));
}

// --- what open_dataset refuses -------------------------------------------------------------------------------------

class DamagedTest : public DatasetTest {
protected:
    DamagedTest() : folder_(root_ / "set"), json_(folder_ / "dataset.json") {
        write_random(folder_, Encoding::u8_srgb, {{16, 8, true, 1}, {16, 8, false, 1}});
        text_ = read_text(json_);
    }
    /// dataset.json with the first `from` replaced.
    std::string with(const std::string& from, const std::string& to) const {
        std::string text = text_;
        const size_t at = text.find(from);
        EXPECT_NE(at, std::string::npos) << from;
        return text.replace(at, from.size(), to);
    }
    std::string open_with(const std::string& from, const std::string& to) const {
        write_text(json_, with(from, to));
        return open_complaint();
    }
    std::string open_complaint() const {
        const std::string text = complaint([&] { open_dataset(folder_); });
        expect_in(folder_.string(), text);
        return text;
    }

    fs::path folder_, json_;
    std::string text_;
};

TEST_F(DamagedTest, MissingFiles) {
    expect_in("no such folder", complaint([&] { open_dataset(root_ / "nothing"); }));
    expect_in("give the folder", complaint([&] { open_dataset(json_); }));
    fs::remove(folder_ / "mesh.ply");
    expect_in("mesh.ply", open_complaint());
    fs::remove(folder_ / "images.bin");
    expect_in("images.bin", open_complaint());
    fs::remove(json_);
    expect_in("no dataset.json", open_complaint());
}

TEST_F(DamagedTest, Json) {
    write_text(json_, "");
    expect_in("run radiafit generate or import again", open_complaint());
    expect_in("line 3 ", open_with("\"version\": 1", "\"version\" 1"));
    expect_in("\"version\" is 4", open_with("\"version\": 1", "\"version\": 4"));
    expect_in("\"format\" is \"gltf\"", open_with("radiafit-dataset", "gltf"));
    expect_in("u8-srgb", open_with("u8-srgb", "u8-adobe"));
    expect_in("\"encoding\" is missing", open_with("\"encoding\"", "\"coding\""));
    expect_in("views[0].camera.fx", open_with("\"fx\"", "\"f_x\""));
    expect_in("views[0].held_out", open_with("\"held_out\":false", "\"held_out\":0"));
    expect_in("\"views\" is empty", complaint([&] {
                  write_text(json_, text_.substr(0, text_.find("\"views\"")) + "\"views\": []}");
                  open_dataset(folder_);
              }));
    write_text(json_, text_.substr(0, text_.size() / 2));
    expect_in("not valid JSON", open_complaint());
}

TEST_F(DamagedTest, Cameras) {
    const auto number_of = [&](const std::string& key) {
        const size_t begin = text_.find("\"" + key + "\":") + key.size() + 3;
        return "\"" + key + "\":" + text_.substr(begin, text_.find_first_of(",}", begin) - begin);
    };
    expect_in("fx", open_with(number_of("fx"), "\"fx\":null"));  // how writers spell NaN
    expect_in("too large", open_with(number_of("fx"), "\"fx\":1e999"));
    expect_in("focal", open_with(number_of("fx"), "\"fx\":-3.5"));
    expect_in("width", open_with("\"width\":16", "\"width\":0"));
    expect_in("width", open_with("\"width\":16", "\"width\":-16"));
    expect_in("height", open_with("\"height\":8", "\"height\":80000000000"));
    expect_in("gain", open_with("\"gain\":1.0", "\"gain\":0.0"));
    const size_t begin = text_.find("[[") + 2;
    const std::string entry = text_.substr(begin, text_.find(',', begin) - begin);
    expect_in("orthonormal", open_with("[[" + entry, "[[9.0"));
}

/// A dataset of two views under a light each, with a normal per texel.
class LitTest : public DatasetTest {
protected:
    static constexpr int side = 3;
    LitTest() : folder_(root_ / "set") {
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
    void write() const {
        DatasetWriter writer(folder_);
        for (const Light& light : lights_) writer.add(view(light), std::vector<uint8_t>(48).data(), {});
        writer.finish(header_);
    }
    std::string open_with(const std::string& from, const std::string& to) const {
        write();
        std::string text = read_text(folder_ / "dataset.json");
        const size_t at = text.find(from);
        EXPECT_NE(at, std::string::npos) << from;
        write_text(folder_ / "dataset.json", text.replace(at, from.size(), to));
        return complaint([&] { open_dataset(folder_); });
    }

    fs::path folder_;
    Dataset header_;
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
    expect_in("--surface-side 3", complaint([&] { reflectance_atlas(dataset, 4); }));
    write();  // an earlier one is replaced, normals and all
    EXPECT_NE(read_text(folder_ / "dataset.json").find("\"version\": 2"), std::string::npos);
}

TEST_F(LitTest, WithoutLightsNormalsAndFloatsTheVersionIsStill1) {
    write_random(folder_, Encoding::u16_linear, {{4, 4, false, 1}});
    EXPECT_NE(read_text(folder_ / "dataset.json").find("\"version\": 1"), std::string::npos);
    const Dataset dataset = open_dataset(folder_);
    EXPECT_FALSE(dataset.light_moves());
    EXPECT_EQ(dataset.normal_map.side, 0);
    const TriangleAtlas plain(dataset.mesh, 5), atlas = reflectance_atlas(dataset, 5);
    for (uint32_t t = 0; t < atlas.texel_count(); ++t) EXPECT_EQ(atlas.normal(t), plain.normal(t));
    write_random(folder_, Encoding::f32_linear, {{4, 4, false, 1}});
    EXPECT_NE(read_text(folder_ / "dataset.json").find("\"version\": 2"), std::string::npos);
}

TEST_F(LitTest, WriterRefusesLightsThatAreNone) {
    DatasetWriter writer(folder_);
    const std::vector<uint8_t> pixels(48);
    const auto refused = [&](const Light& light) {
        return complaint([&] { writer.add(view(light), pixels.data(), {}); });
    };
    expect_in("unit vector", refused({Light::Kind::distant, Vec3d::Zero(), Vec3d::Ones()}));
    expect_in("not finite", refused({Light::Kind::near, Vec3d(NAN, 0, 0), Vec3d::Ones()}));
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
    expect_in("normal 5 ", complaint([&] { open_dataset(folder_); }));
    fs::remove(folder_ / "normals.f32");
    expect_in("normals.f32", complaint([&] { open_dataset(folder_); }));
}

/// A tilted grid of 5 x 3 texels, seen by a near camera and by one far away, each under its light.
class GridTest : public DatasetTest {
protected:
    static constexpr int width = 5, height = 3;
    GridTest() : folder_(root_ / "set") {
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
    void write() const {
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
    std::string open_with(const std::string& from, const std::string& to) const {
        write();
        std::string text = read_text(folder_ / "dataset.json");
        const size_t at = text.find(from);
        EXPECT_NE(at, std::string::npos) << from;
        write_text(folder_ / "dataset.json", text.replace(at, from.size(), to));
        return complaint([&] { open_dataset(folder_); });
    }

    fs::path folder_;
    Dataset header_;
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
    EXPECT_NE(read_text(folder_ / "dataset.json").find("\"version\": 3"), std::string::npos);
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
    expect_in("5 x 3 texels need 180", complaint([&] { open_dataset(folder_); }));
}

TEST_F(DamagedTest, ImagesThatDoNotFit) {
    const fs::path images = folder_ / "images.bin";
    const uint64_t bytes = fs::file_size(images);
    expect_in("run radiafit generate or import again", open_with("\"pixel_offset\":4096", "\"pixel_offset\":4000"));
    write_text(json_, text_);
    expect_in("multiple of 4096", open_with("\"pixel_offset\":4096", "\"pixel_offset\":4000"));
    expect_in("ends at byte", open_with("\"pixel_offset\":4096", "\"pixel_offset\":81920"));
    expect_in("ends at byte", open_with("\"mask_offset\":384", "\"mask_offset\":18446744073709551610"));
    expect_in("ends at byte", open_with("\"width\":16", "\"width\":16000"));
    write_text(json_, text_);
    fs::resize_file(images, bytes - 1);
    expect_in(std::to_string(bytes - 1) + " bytes", open_complaint());
    fs::resize_file(images, bytes + 4096);
    open_complaint();
    fs::resize_file(images, bytes);
    EXPECT_NO_THROW(open_dataset(folder_));
}

TEST_F(DamagedTest, Meshes) {
    const fs::path file = folder_ / "mesh.ply";
    const std::string ply = read_text(file);
    const auto open_with_mesh = [&](const std::string& content) {
        write_text(file, content);
        return complaint([&] { open_dataset(folder_); });
    };
    for (const size_t length : {size_t(0), size_t(3), size_t(40), ply.size() / 2, ply.size() - 1}) {
        const std::string text = open_with_mesh(ply.substr(0, length));
        expect_in("mesh.ply", text);
        expect_in("generate or import", text);
    }
    const auto replaced = [&](const std::string& from, const std::string& to) {
        std::string text = ply;
        return text.replace(text.find(from), from.size(), to);
    };
    expect_in("binary_little_endian", open_with_mesh(replaced("binary_little_endian", "ascii")));
    expect_in("counts", open_with_mesh(replaced("vertex 4", "vertex x")));
    expect_in("bytes, but the file has", open_with_mesh(replaced("vertex 4", "vertex 4000000000")));

    const auto open_with_changed_mesh = [&](const std::function<void(Mesh&)>& change) {
        Mesh mesh = tetrahedron();
        change(mesh);
        write_ply(mesh, file);
        const std::string text = complaint([&] { open_dataset(folder_); });
        expect_in("mesh.ply", text);
        return text;
    };
    expect_in("empty", open_with_changed_mesh([](Mesh& m) { m.triangles.clear(); }));
    expect_in("empty", open_with_changed_mesh([](Mesh& m) { m = {}; }));
    expect_in("finite",
              open_with_changed_mesh([](Mesh& m) { m.positions[2].y() = std::numeric_limits<float>::quiet_NaN(); }));
    expect_in("triangle 1", open_with_changed_mesh([](Mesh& m) { m.triangles[1][2] = 4; }));
    expect_in("dataset.json says", open_with_changed_mesh([](Mesh& m) { m.triangles.pop_back(); }));
}

TEST_F(DamagedTest, AFileThatShrinksUnderTheStreamIsASystemError) {
    const Dataset dataset = open_dataset(folder_);
    ImageStream stream(dataset, StreamSource::disk);
    TargetImage image;
    stream.load(1, image);
    fs::resize_file(folder_ / "images.bin", 4096 + 100);
    EXPECT_THROW(stream.load(1, image), SystemError);
    EXPECT_THROW(ImageStream(dataset, StreamSource::memory), SystemError);
    fs::remove(folder_ / "images.bin");
    EXPECT_THROW(ImageStream(dataset, StreamSource::disk), SystemError);
}

// --- the writer ----------------------------------------------------------------------------------------------------

View small_view() {
    View view;
    view.name = "one";
    view.camera = Camera::look_at({0, -3, 0}, {0, 0, 0}, {0, 0, 1}, 0.6, 4, 4);
    return view;
}

void add_one(DatasetWriter& writer, uint8_t value) {
    writer.add(small_view(), std::vector<uint8_t>(48, value).data(), {});
}

Dataset header_named(const std::string& name) {
    Dataset header;
    header.name = name;
    header.mesh = tetrahedron();
    return header;
}

TEST_F(DatasetTest, AnUnfinishedWriterLeavesNothing) {
    {
        DatasetWriter writer(root_ / "set");
        add_one(writer, 1);
        EXPECT_FALSE(fs::exists(root_ / "set"));
    }
    EXPECT_EQ(entries(), 0u);
}

TEST_F(DatasetTest, ReplacingKeepsTheOldSetUntilTheNewOneIsWhole) {
    const fs::path folder = root_ / "set";
    {
        DatasetWriter writer(folder);
        add_one(writer, 1);
        writer.finish(header_named("old"));
    }
    {
        DatasetWriter writer(folder);
        add_one(writer, 2);
        EXPECT_EQ(open_dataset(folder).name, "old");
    }
    EXPECT_EQ(open_dataset(folder).name, "old");
    {
        DatasetWriter writer(folder);
        add_one(writer, 2);
        Dataset header = header_named("new");
        header.mesh.triangles.clear();
        EXPECT_THROW(writer.finish(header), UserError);
    }
    EXPECT_EQ(open_dataset(folder).name, "old");
    EXPECT_EQ(entries(), 1u);

    fs::create_directory_symlink(folder, root_ / "link");
    {
        DatasetWriter writer(root_ / "link" / "");
        add_one(writer, 2);
        writer.finish(header_named("new"));
    }
    EXPECT_TRUE(fs::is_symlink(root_ / "link"));
    EXPECT_EQ(open_dataset(folder).name, "new");
    EXPECT_EQ(entries(), 2u);

    write_text(folder / "dataset.json", "{ damaged");  // the advice of open_dataset must work
    DatasetWriter writer(folder);
    add_one(writer, 3);
    writer.finish(header_named("newer"));
    EXPECT_EQ(open_dataset(folder).name, "newer");
}

TEST_F(DatasetTest, WhatIsNoDatasetIsNeverReplaced) {
    const fs::path folder = root_ / "photographs";
    fs::create_directories(folder);
    { DatasetWriter accepts_an_empty_folder(folder); }
    EXPECT_TRUE(fs::exists(folder));
    write_text(folder / "images.bin", "precious");
    expect_in("choose another name", complaint([&] { DatasetWriter writer(folder); }));
    write_text(folder / "dataset.json", "{}");
    write_text(folder / "notes.txt", "precious");
    expect_in("notes.txt", complaint([&] { DatasetWriter writer(folder); }));
    expect_in("a file", complaint([&] { DatasetWriter writer(folder / "notes.txt"); }));
    EXPECT_EQ(read_text(folder / "notes.txt"), "precious");
    EXPECT_EQ(entries(), 1u);
}

TEST_F(DatasetTest, UnwritableOutputIsOneLine) {
    write_text(root_ / "file", "");
    expect_in("cannot write", complaint([&] { DatasetWriter writer(root_ / "file" / "set"); }));
    if (geteuid() != 0) {  // root may write anywhere
        fs::permissions(root_, fs::perms::owner_read | fs::perms::owner_exec);
        expect_in("writable", complaint([&] { DatasetWriter writer(root_ / "set"); }));
    }
}

TEST_F(DatasetTest, AFullDiskIsOneLine) {
    // A limit on the file size is the full disk that a test can make: write() fails half-way.
    rlimit old_limit{};
    getrlimit(RLIMIT_FSIZE, &old_limit);
    const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
    rlimit limit = old_limit;
    limit.rlim_cur = 10000;
    setrlimit(RLIMIT_FSIZE, &limit);
    const std::string text = complaint([&] {
        DatasetWriter writer(root_ / "set");
        for (int i = 0; i < 5; ++i) add_one(writer, 1);
    });
    setrlimit(RLIMIT_FSIZE, &old_limit);
    std::signal(SIGXFSZ, old_handler);
    expect_in("images.bin", text);
    expect_in("free some space", text);
    EXPECT_EQ(entries(), 0u);
}

TEST_F(DatasetTest, WriterRefusesWhatCannotBeFitted) {
    DatasetWriter writer(root_ / "set");
    EXPECT_THROW(writer.finish(header_named("empty")), UserError);
    View view = small_view();
    view.camera.cx = std::numeric_limits<double>::quiet_NaN();
    const std::vector<uint8_t> pixels(48);
    expect_in("one", complaint([&] { writer.add(view, pixels.data(), {}); }));
    view = small_view();
    view.gain = -1;
    expect_in("gain", complaint([&] { writer.add(view, pixels.data(), {}); }));
    writer.set_encoding(Encoding::f16_linear);
    std::vector<uint16_t> halves(48, 0);
    halves[5] = 0x7c00;  // infinity
    expect_in("channel 2 of pixel 1", complaint([&] { writer.add(small_view(), halves.data(), {}); }));
    EXPECT_THROW(writer.add(small_view(), pixels.data(), std::vector<uint8_t>(3)), std::logic_error);
    writer.add(small_view(), std::vector<uint16_t>(48).data(), {});
    EXPECT_THROW(writer.set_encoding(Encoding::u8_srgb), std::logic_error);
}

}  // namespace
}  // namespace radiafit

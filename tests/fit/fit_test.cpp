#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstring>
#include <fstream>
#include <limits>
#include <sstream>

#include "fit/fit_folder.h"
#include "fit/fit_maps.h"
#include "fit_scene.h"
#include "geometry/raster.h"
#include "image/exr.h"
#include "image/exr_header.h"

namespace radiafit::testing {
namespace {

namespace fs = std::filesystem;

bool same_bits(const std::vector<float>& a, const std::vector<float>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), 4 * a.size()) == 0;
}

std::string text_of(const fs::path& path) {
    std::ifstream in(path, std::ios::binary);
    std::ostringstream text;
    text << in.rdbuf();
    return text.str();
}

void put(const fs::path& path, const std::string& text) { std::ofstream(path, std::ios::binary) << text; }

void replace_in(const fs::path& path, const std::string& from, const std::string& to) {
    std::string text = text_of(path);
    const size_t at = text.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    put(path, text.replace(at, from.size(), to));
}

size_t entries(const fs::path& folder) {
    return size_t(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

TEST(Exr, Float32KeepsEveryBit) {
    const TemporaryFolder folder;
    ExrImage image{7, 3, {"R", "error.G", "A"}, {}, {{"note", "two words"}}};
    Rng rng(3);
    for (int i = 0; i < 7 * 3 * 3; ++i) {
        const uint32_t bits = rng.bits();  // any pattern: NaN payloads, infinities, denormals
        float value;
        std::memcpy(&value, &bits, 4);
        image.values.push_back(value);
    }
    image.values[0] = std::numeric_limits<float>::quiet_NaN();
    image.values[1] = -std::numeric_limits<float>::infinity();
    image.values[2] = -0.0f;
    image.values[3] = std::numeric_limits<float>::denorm_min();
    write_exr(folder.path() / "a.exr", image);
    const ExrImage back = read_exr(folder.path() / "a.exr", image.channels);
    EXPECT_EQ(back.width, 7);
    EXPECT_EQ(back.height, 3);
    EXPECT_TRUE(same_bits(back.values, image.values));
    EXPECT_EQ(back.notes.at("note"), "two words");
    // Without names: alphabetic order, so A comes first.
    const ExrImage all = read_exr(folder.path() / "a.exr");
    EXPECT_EQ(all.channels, (std::vector<std::string>{"A", "R", "error.G"}));
    EXPECT_EQ(std::memcmp(&all.values[3 * 5], &image.values[3 * 5 + 2], 4), 0);
    EXPECT_EQ(entries(folder.path()), 1u) << "a temporary file was left";
}

TEST(Exr, Float16RoundsToNearestEven) {
    const TemporaryFolder folder;
    // Midpoints between neighbouring halves at 1: 1 + 2^-11 lies between 1 and 1 + 2^-10, ties go to the even one.
    const ExrImage image{4, 1, {"R"}, {1.0f + 0x1p-11f, 1.0f + 3 * 0x1p-11f, 1.0f + 0x1.002p-11f, 65504.0f}, {}};
    write_exr(folder.path() / "a.exr", image, ExrType::float16);
    const ExrImage back = read_exr(folder.path() / "a.exr");
    EXPECT_TRUE(same_bits(back.values, {1.0f, 1.0f + 0x1p-9f, 1.0f + 0x1p-10f, 65504.0f}));
}

TEST(Exr, BadFilesAreOneLine) {
    const TemporaryFolder folder;
    const fs::path path = folder.path() / "a.exr";
    EXPECT_NE(user_error([&] { read_exr(path); }).find("a.exr"), std::string::npos);
    put(path, "this is no image");
    EXPECT_NE(user_error([&] { read_exr(path); }).find("a.exr"), std::string::npos);
    const ExrImage image{64, 64, {"R"}, std::vector<float>(64 * 64, 0.5f), {}};
    write_exr(path, image);
    EXPECT_NE(user_error([&] { read_exr(path, {"G"}); }).find("channel G"), std::string::npos);
    fs::resize_file(path, fs::file_size(path) / 2);
    EXPECT_NE(user_error([&] { read_exr(path); }).find("a.exr"), std::string::npos);
    const std::string unwritable = user_error([&] { write_exr(folder.path() / "missing" / "b.exr", image); });
    EXPECT_NE(unwritable.find("b.exr"), std::string::npos);
}

class FitFolder : public ::testing::TestWithParam<std::tuple<int, bool>> {};

TEST_P(FitFolder, RoundTripIsExact) {
    const TemporaryFolder folder;
    const Dataset dataset = noise_dataset(folder.path() / "data");
    const auto [terms, own_sides] = GetParam();
    LightFieldFit fit = random_fit(dataset, terms, ViewLookup::nearest, 5, own_sides);
    fit.parameters[0] = -std::numeric_limits<float>::quiet_NaN();
    fit.error[2] = std::numeric_limits<float>::infinity();
    fit.status[2] = Status::not_finite;
    fit.space = TargetSpace::linear;
    fit.options.mode = Mode::paper;
    fit.surface = SurfaceLookup::linear;
    fit.options_json = R"({"iterations":25,"terms":2})";
    fit.provenance_json = R"({"git":"abc"})";
    fit.times_json = R"({"optimize":1.5})";
    const fs::path where = folder.path() / "fits" / "one";
    write_fit(where, fit, dataset.mesh, [](const fs::path& place) { put(place / "trace.csv", "iteration\n0\n"); });
    const auto [back, mesh] = read_fit(where);

    EXPECT_TRUE(same_bits(back.parameters, fit.parameters));
    EXPECT_TRUE(same_bits(back.error, fit.error));
    EXPECT_EQ(back.status, fit.status);
    EXPECT_EQ(back.iterations, fit.iterations);
    EXPECT_EQ(back.samples, fit.samples);
    EXPECT_EQ(back.options.terms, fit.options.terms);
    EXPECT_EQ(back.options.surface_side, fit.options.surface_side);
    ASSERT_EQ(back.options.sides != nullptr, own_sides);
    if (own_sides) {
        EXPECT_EQ(*back.options.sides, *fit.options.sides);
    }
    EXPECT_EQ(back.options.view_side, fit.options.view_side);
    EXPECT_EQ(back.options.lookup, fit.options.lookup);
    EXPECT_EQ(back.surface, fit.surface);
    EXPECT_EQ(back.options.mode, fit.options.mode);
    EXPECT_EQ(back.options.lambda_surface, fit.options.lambda_surface);
    EXPECT_EQ(back.options.lambda_view, fit.options.lambda_view);
    EXPECT_EQ(back.options.mu, fit.options.mu);
    EXPECT_EQ(back.options.lower, fit.options.lower);
    EXPECT_EQ(back.options.upper, fit.options.upper);
    EXPECT_EQ(back.space, fit.space);
    EXPECT_EQ(back.encoding, fit.encoding);
    EXPECT_EQ(back.solver, "stream");
    EXPECT_EQ(back.engine, "cpu");
    EXPECT_EQ(back.options_json, fit.options_json);
    EXPECT_EQ(back.provenance_json, fit.provenance_json);
    EXPECT_EQ(back.times_json, fit.times_json);
    EXPECT_EQ(back.dataset_fingerprint, fit.dataset_fingerprint);
    EXPECT_EQ(mesh.positions, dataset.mesh.positions);
    EXPECT_EQ(mesh.triangles, dataset.mesh.triangles);
    EXPECT_EQ(text_of(where / "trace.csv"), "iteration\n0\n");
    EXPECT_EQ(open_fitted_dataset(back).views.size(), dataset.views.size());
    EXPECT_EQ(entries(folder.path() / "fits"), 1u) << "a temporary folder was left";
    // No path of this machine stands in the file: the dataset is found relative to the fit.
    EXPECT_EQ(text_of(where / "fit.json").find(folder.path().string()), std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(Terms, FitFolder, ::testing::Combine(::testing::Values(1, 2, 3), ::testing::Bool()));

// The format, as docs/formats.md tells it, read without the code that wrote it: only cells and offsets by hand.
class FitPlaces : public ::testing::TestWithParam<bool> {};  // surface maps of their own sides
TEST_P(FitPlaces, AreAsDocumented) {
    const TemporaryFolder folder;
    const Dataset dataset = noise_dataset(folder.path() / "data");
    const LightFieldFit fit = random_fit(dataset, 2, ViewLookup::bilinear, 6, GetParam());
    write_fit(folder.path() / "fit", fit, dataset.mesh);
    const VertexRings rings(dataset.mesh);
    const int n = GetParam() ? int(*std::ranges::max_element(*fit.options.sides)) : 5, m = 3, terms = 2;
    ASSERT_EQ(fit.options.surface_side, n);
    const auto side = [&](uint32_t t) { return GetParam() ? int((*fit.options.sides)[t]) : n; };
    const auto texels_before = [&](size_t v, uint32_t triangle) {  // of a vertex's maps
        size_t texels = 0;
        for (const Corner& c : rings.ring(v))
            texels += c.triangle < triangle ? size_t(side(c.triangle) * (side(c.triangle) + 1) / 2) : 0;
        return texels;
    };
    if (GetParam()) {
        const ExrImage sides = read_exr(folder.path() / "fit" / "sides.exr", {"side"});
        ASSERT_EQ(sides.width, int(std::ceil(std::sqrt(double(dataset.mesh.triangle_count())))));
        for (uint32_t t = 0; t < dataset.mesh.triangle_count(); ++t) ASSERT_EQ(sides.values[t], float(side(t)));
    }
    const size_t vertices = dataset.mesh.vertex_count();
    const int columns = int(std::ceil(std::sqrt(double(vertices))));
    for (int term = 0; term < terms; ++term) {
        const ExrImage view = read_exr(folder.path() / "fit" / ("view_term" + std::to_string(term) + ".exr"), {"G"});
        ASSERT_EQ(view.width, columns * m);
        size_t block = 0;
        for (size_t v = 0; v < vertices; ++v) {
            const size_t maps = texels_before(v, no_triangle) * terms * 4;
            for (int y = 0; y < m; ++y)
                for (int x = 0; x < m; ++x) {
                    const int column = int(v) % columns * m + x, row = int(v) / columns * m + y;
                    EXPECT_EQ(view.values[size_t(row * view.width + column)],
                              fit.parameters[block + maps + size_t(((y * m + x) * terms + term) * 4 + 1)]);
                }
            block += maps + size_t(m * m * terms * 4);
        }
        for (int corner = 0; corner < 3; ++corner) {
            const ExrImage surface =
                read_exr(folder.path() / "fit" /
                             ("surface_term" + std::to_string(term) + "_corner" + std::to_string(corner) + ".exr"),
                         {"B"});
            // Triangle 1 is the second of the first n x (n + 1) rectangle: turned, so cell (i, j) is at (n-1-i, n-j).
            const size_t vertex = dataset.mesh.triangles[1][size_t(corner)];
            size_t map = texels_before(vertex, 1) * terms * 4;
            for (size_t v = 0; v < vertex; ++v) map += (texels_before(v, no_triangle) + size_t(m * m)) * terms * 4;
            int local = 0;
            for (int j = 0; j < side(1); ++j)
                for (int i = 0; i + j < side(1); ++i, ++local)
                    EXPECT_EQ(surface.values[size_t((n - j) * surface.width + n - 1 - i)],
                              fit.parameters[map + size_t((local * terms + term) * 4 + 2)]);
        }
    }
    const ExrImage problems = read_exr(folder.path() / "fit" / "problems.exr", {"samples.B"});
    ASSERT_EQ(problems.width, columns);
    for (size_t v = 0; v < vertices; ++v) EXPECT_EQ(problems.values[v], float(fit.samples[3 * v + 2]));
}
INSTANTIATE_TEST_SUITE_P(OwnSides, FitPlaces, ::testing::Bool());

TEST(FitFiles, TargetIsGuarded) {
    const TemporaryFolder folder;
    const Dataset dataset = noise_dataset(folder.path() / "data");
    LightFieldFit fit = random_fit(dataset, 1, ViewLookup::bilinear, 7);
    const fs::path where = folder.path() / "fit";
    fs::create_directories(where);
    check_fit_target(where);  // an empty folder may be filled
    put(where / "letter.txt", "dear");
    EXPECT_NE(user_error([&] { check_fit_target(where); }).find("fit"), std::string::npos);
    EXPECT_NE(user_error([&] { write_fit(where, fit, dataset.mesh); }).find("fit"), std::string::npos);
    EXPECT_EQ(text_of(where / "letter.txt"), "dear");
    fs::remove(where / "letter.txt");

    write_fit(where, fit, dataset.mesh);
    fit.solver = "second";
    write_fit(where / "", fit, dataset.mesh);  // a fit is replaced, with or without a slash
    EXPECT_EQ(read_fit(where).fit.solver, "second");
    // A failure half-way leaves the earlier fit and nothing else.
    fit.solver = "third";
    EXPECT_THROW(write_fit(where, fit, dataset.mesh,
                           [](const fs::path& place) {
                               put(place / "trace.csv", "half");
                               throw SystemError("disk");
                           }),
                 SystemError);
    EXPECT_EQ(read_fit(where).fit.solver, "second");
    EXPECT_EQ(entries(folder.path()), 2u);
    // A file that somebody put beside the maps is not the fit's to delete.
    put(where / "notes.txt", "mine");
    EXPECT_NE(user_error([&] { write_fit(where, fit, dataset.mesh); }).find("notes.txt"), std::string::npos);
    EXPECT_EQ(text_of(where / "notes.txt"), "mine");
    EXPECT_NE(user_error([&] { check_fit_target(where / "fit.json"); }).find("fit.json"), std::string::npos);
    EXPECT_NE(user_error([&] { write_fit(where / "fit.json" / "below", fit, dataset.mesh); }).find("below"),
              std::string::npos);
}

class Corruption : public ::testing::Test {
protected:
    void SetUp() override {
        dataset = noise_dataset(folder.path() / "data");
        fit = random_fit(dataset, 2, ViewLookup::bilinear, 8);
        write_fit(where, fit, dataset.mesh);
        read_fit(where);
    }
    // Damages the fit, expects one line that holds `expected`, and repairs it.
    void expect(const std::string& expected, const std::function<void()>& damage) {
        damage();
        const std::string said = user_error([&] { read_fit(where); });
        EXPECT_NE(said.find(expected), std::string::npos) << said;
        fs::remove_all(where);
        write_fit(where, fit, dataset.mesh);
    }
    void rewrite(const std::string& name, const std::function<void(ExrImage&)>& change) {
        ExrImage image = read_exr(where / name);
        change(image);
        write_exr(where / name, image);
    }
    TemporaryFolder folder;
    fs::path where = folder.path() / "fit";
    Dataset dataset;
    LightFieldFit fit;
};

TEST_F(Corruption, EveryFileIsNeeded) {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(where)) names.push_back(entry.path().filename().string());
    EXPECT_EQ(names.size(), 3u + 2 * 4);  // fit.json, mesh.ply, problems.exr; 3 surface maps and a view map per term
    for (const std::string& name : names) {
        expect(name, [&] { fs::remove(where / name); });
        expect(name, [&] { fs::resize_file(where / name, fs::file_size(where / name) / 2); });
        expect(name, [&] { put(where / name, ""); });
    }
    EXPECT_NE(user_error([&] { read_fit(folder.path() / "nowhere"); }).find("nowhere"), std::string::npos);
}

TEST_F(Corruption, ImagesOfAnotherShapeOrMeaning) {
    for (const std::string name : {"problems.exr", "view_term1.exr", "surface_term0_corner2.exr"}) {
        expect(name, [&] {
            rewrite(name, [](ExrImage& image) {
                ++image.height;
                image.values.resize(size_t(image.width) * size_t(image.height) * image.channels.size());
            });
        });
        expect(name, [&] { rewrite(name, [](ExrImage& image) { image.channels[0] = "X"; }); });
    }
    const auto set = [&](const std::string& channel, float value) {
        rewrite("problems.exr", [&](ExrImage& image) {
            const auto at = std::find(image.channels.begin(), image.channels.end(), channel);
            image.values[size_t(at - image.channels.begin())] = value;
        });
    };
    expect("status = nan", [&] { set("status.G", NAN); });
    expect("status = 8", [&] { set("status.G", 8); });
    expect("status = 1.5", [&] { set("status.G", 1.5); });
    expect("samples = -1", [&] { set("samples.R", -1); });
    expect("iterations = inf", [&] { set("iterations.B", INFINITY); });
    expect("disagree with those counted", [&] { set("status.G", 0); });
}

TEST_F(Corruption, SidesOfSurfaceMaps) {
    fit = random_fit(dataset, 2, ViewLookup::bilinear, 8, true);
    fs::remove_all(where);
    write_fit(where, fit, dataset.mesh);
    expect("sides.exr", [&] { fs::remove(where / "sides.exr"); });
    for (const float side : {1.0f, 6.0f, 2.5f, NAN})
        expect("sides.exr", [&] { rewrite("sides.exr", [&](ExrImage& image) { image.values[3] = side; }); });
    const uint8_t first = fit.options.sides->front();
    expect("sides.exr: not as fit.json describes it", [&] {
        rewrite("sides.exr", [&](ExrImage& image) { image.values[0] = float(first == 2 ? 3 : first - 1); });
    });
    expect("fit.json", [&] { replace_in(where / "fit.json", "\"sides\": \"", "\"size\": \""); });
    expect("lists sides.exr", [&] { replace_in(where / "fit.json", "\"version\": 2", "\"version\": 1"); });
}

TEST_F(Corruption, SizesInHeadersAreComparedBeforeMemoryIsTaken) {
    const auto grow = [](const fs::path& file) {
        std::string bytes = text_of(file);
        const std::string name = std::string("dataWindow") + '\0' + "box2i" + '\0';
        const size_t at = bytes.find(name) + name.size() + 4 + 8;  // behind the attribute's size and the first corner
        const int32_t last[2] = {15999, 15999};
        std::memcpy(bytes.data() + at, last, sizeof last);
        put(file, bytes + std::string(30'000, '\0'));  // room for the table of its lines
    };
    for (const std::string name : {"problems.exr", "view_term1.exr", "surface_term0_corner2.exr"})
        expect(name + ": 16000 x 16000 pixels where", [&] { grow(where / name); });
    grow(where / "problems.exr");
    EXPECT_NE(user_error([&] { read_exr(where / "problems.exr"); }).find("16000 x 16000 pixels cannot be in"),
              std::string::npos);
}

TEST_F(Corruption, AttributesEndWithinTheFile) {
    const fs::path map = where / "problems.exr";
    std::string bytes = text_of(map);
    const std::string name = std::string("compression") + '\0' + "compression" + '\0';
    const uint32_t huge = 0x70000000;
    std::memcpy(bytes.data() + bytes.find(name) + name.size(), &huge, sizeof huge);
    expect("problems.exr: cannot be read as OpenEXR (its header ends within an attribute)", [&] { put(map, bytes); });
}

// OpenEXR reads by type, not by length: the two must agree on where the next attribute begins.
TEST_F(Corruption, AttributesAreAsLongAsTheirTypes) {
    const fs::path map = where / "problems.exr";
    const std::string whole = text_of(map);
    const std::pair<const char*, const char*> attributes[] = {
        {"channels", "chlist"}, {"dataWindow", "box2i"}, {"lineOrder", "lineOrder"}};
    for (const auto& [name, type] : attributes)
        for (const int off : {-1, 1}) {
            std::string bytes = whole;
            const std::string head = std::string(name) + '\0' + type + '\0';
            bytes[bytes.find(head) + head.size()] += char(off);
            expect(fmt::format("problems.exr: cannot be read as OpenEXR (its attribute {} is damaged)", name),
                   [&] { put(map, bytes); });
        }
    const auto bytes = [](std::initializer_list<int> values) { return std::string(values.begin(), values.end()); };
    EXPECT_TRUE(exr_attribute_fits("preview", bytes({2, 0, 0, 0, 1, 0, 0, 0, 1, 2, 3, 4, 5, 6, 7, 8})));
    EXPECT_FALSE(exr_attribute_fits("preview", bytes({0, 0, 0, 1, 0, 0, 0, 1})));
    EXPECT_FALSE(exr_attribute_fits("preview", bytes({2, 0, 0, 0})));
    EXPECT_FALSE(exr_attribute_fits("chlist", ""));
    EXPECT_TRUE(exr_attribute_fits("chlist", bytes({0})));
    EXPECT_TRUE(exr_attribute_fits("of another program", "anything"));
}

TEST_F(Corruption, FitWithoutASurfaceLookUpMeansTheNearest) {
    replace_in(where / "fit.json", "\"surface_lookup\": \"nearest\",", "");
    EXPECT_EQ(read_fit(where).fit.surface, SurfaceLookup::nearest);
}

TEST_F(Corruption, FitJson) {
    const auto edit = [&](const std::string& from, const std::string& to) {
        return [this, from, to] { replace_in(where / "fit.json", from, to); };
    };
    expect("fit.json", edit("{", "["));
    expect("format", edit("radiafit-fit", "something"));
    expect("version", edit("\"version\": 1", "\"version\": 99"));
    expect("fit.json", edit("\"terms\": 2", "\"terms\": 0"));
    expect("fit.json", edit("\"terms\": 2", "\"terms\": \"two\""));
    expect("terms is true", edit("\"terms\": 2", "\"terms\": true"));
    expect("terms is 2.9", edit("\"terms\": 2", "\"terms\": 2.9"));
    expect("terms is 4294967298", edit("\"terms\": 2", "\"terms\": 4294967298"));
    expect("mu is true", edit("\"mu\": 1", "\"mu\": true, \"nu\": 1"));
    expect("views is -1", edit("\"views\": 5", "\"views\": -1"));
    expect("nested", edit("\"options\": {}", "\"options\": " + std::string(100'000, '[') + std::string(100'000, ']')));
    expect("fit.json", edit("\"lookup\": \"bilinear\"", "\"lookup\": \"cubic\""));
    expect("unknown surface look-up", edit("\"surface_lookup\": \"nearest\"", "\"surface_lookup\": \"cubic\""));
    expect("fit.json", edit("\"space\": \"stored\"", "\"space\": \"outer\""));
    expect("fit.json", edit("\"lambda_view\"", "\"lambda_vies\""));
    expect("surface_term0_corner", edit("\"surface_side\": 5", "\"surface_side\": 6"));
    expect("view_term", edit("\"view_side\": 3", "\"view_side\": 4"));
    expect("mesh.ply", edit("\"vertices\": ", "\"vertices\": 1"));
}

TEST_F(Corruption, AnotherDataset) {
    const LightFieldFit back = read_fit(where).fit;
    EXPECT_EQ(open_fitted_dataset(back).name, "sheet");
    fs::rename(folder.path() / "data", folder.path() / "moved");
    EXPECT_NE(user_error([&] { open_fitted_dataset(back); }).find("data"), std::string::npos);
    EXPECT_EQ(open_fitted_dataset(back, folder.path() / "moved").name, "sheet");

    Dataset changed = dataset;
    const auto differs = [&](const char* what) {
        EXPECT_NE(fingerprint(changed), fit.dataset_fingerprint) << what;
        changed = dataset;
    };
    changed.mesh.positions[3].x() += 1e-6f;
    differs("a vertex");
    std::swap(changed.mesh.triangles[0], changed.mesh.triangles[1]);
    differs("triangle order");
    changed.views[1].camera.fx *= 1.0001;
    differs("a camera");
    changed.views[1].held_out = !changed.views[1].held_out;
    differs("the split");
    changed.views[0].gain = 1.1;
    differs("a gain");
    changed.views[0].gain = Gain({1.1, 1.1, 1.2});
    differs("a channel's gain");
    changed.views.pop_back();
    differs("the number of views");
    EXPECT_EQ(fingerprint(changed), fit.dataset_fingerprint);

    Dataset header = sheet_dataset(troubled_mesh(3, 7, 99), 5, 48, 2);
    write_dataset(folder.path() / "other", header, [](size_t, int, int, int) { return uint8_t(9); });
    EXPECT_NE(user_error([&] { open_fitted_dataset(back, folder.path() / "other"); }).find("differs"),
              std::string::npos);
}

}  // namespace
}  // namespace radiafit::testing

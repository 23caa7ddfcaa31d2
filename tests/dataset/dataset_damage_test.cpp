// What open_dataset and the streams refuse: files that are missing, cut off or changed.
#include <limits>

#include "dataset/dataset.h"
#include "dataset/image_stream.h"
#include "dataset/mesh_ply.h"
#include "dataset/truth.h"
#include "dataset_fixture.h"

namespace radiafit {
namespace {

class DamagedTest : public DatasetTest {
protected:
    DamagedTest() : folder_(root_ / "set"), json_(folder_ / "dataset.json") {
        write_random(folder_, Encoding::u8_srgb, {{16, 8, true, 1}, {16, 8, false, 1}});
        text_ = read_text(json_);
    }
    std::string open_with(const std::string& from, const std::string& to) const {
        write_text(json_, replaced(text_, from, to));
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
    expect_in("make the dataset again", open_complaint());
    expect_in("line 3 ", open_with("\"version\": 4", "\"version\" 4"));
    expect_in("\"version\" is 5", open_with("\"version\": 4", "\"version\": 5"));
    expect_in("\"format\" is \"gltf\"", open_with("radiafit-dataset", "gltf"));
    expect_in("u8-srgb", open_with("u8-srgb", "u8-adobe"));
    expect_in("\"encoding\" is missing", open_with("\"encoding\"", "\"coding\""));
    expect_in("views[0].camera.fx", open_with("\"fx\"", "\"f_x\""));
    expect_in("views[0].held_out", open_with("\"held_out\":false", "\"held_out\":0"));
    expect_in("views[0].checksum", open_with("\"checksum\"", "\"check\""));
    expect_in("16 hexadecimal digits", open_with("\"checksum\":\"", "\"checksum\":\"-"));
    expect_in("checksums.mesh.ply", open_with("\"mesh.ply\":\"", "\"mesh.ply\":\"x"));
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

TEST_F(DamagedTest, ImagesThatDoNotFit) {
    const fs::path images = folder_ / "images.bin";
    const uint64_t bytes = fs::file_size(images);
    expect_in("make the dataset again", open_with("\"pixel_offset\":4096", "\"pixel_offset\":4000"));
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
        expect_in("make the dataset again", text);
    }
    expect_in("binary_little_endian", open_with_mesh(replaced(ply, "binary_little_endian", "ascii")));
    expect_in("counts", open_with_mesh(replaced(ply, "vertex 4", "vertex x")));
    expect_in("bytes, but the file has", open_with_mesh(replaced(ply, "vertex 4", "vertex 4000000000")));

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

TEST_F(DamagedTest, AFileThatShrinksUnderTheStream) {
    const Dataset dataset = open_dataset(folder_);
    ImageStream stream(dataset, StreamSource::disk);
    TargetImage image;
    stream.load(1, image);
    fs::resize_file(folder_ / "images.bin", 4096 + 100);
    expect_in("images.bin: ends at byte 4196", complaint([&] { stream.load(1, image); }));
    expect_in("run again", complaint([&] { ImageStream(dataset, StreamSource::memory); }));
    fs::remove(folder_ / "images.bin");
    EXPECT_THROW(ImageStream(dataset, StreamSource::disk), SystemError);
}

TEST_F(DatasetTest, TruthOfOtherTypesAndCountsIsRefused) {
    ReflectanceTruth truth;
    truth.side = 3;
    truth.materials = {{"gold", "lafortune", {"a", "b"}}};
    truth.material.assign(4, 0);
    truth.parameters.resize(4);
    write_truth(truth, root_);
    EXPECT_EQ(read_truth(root_).material.size(), 4u);
    const std::string whole = read_text(root_ / "truth.json");
    const auto refused = [&](const std::string& from, const std::string& to) {
        write_text(root_ / "truth.json", replaced(whole, from, to));
        return complaint([&] { read_truth(root_); });
    };
    expect_in("\"texels\" is no whole number", refused("\"texels\": 4", "\"texels\": 4.0"));
    // 36 bytes each: the product is that of 4 texels, modulo 2^64
    expect_in("\"texels\"", refused("\"texels\": 4", "\"texels\": " + std::to_string(4 + (uint64_t(1) << 62))));
    expect_in("truth_parameters.f32: the file has 144 bytes", refused("\"texels\": 4", "\"texels\": 4000000000"));
    expect_in("\"side\" is no whole number", refused("\"side\": 3", "\"side\": true"));
    expect_in("\"side\" is no whole number", refused("\"side\": 3", "\"side\": 4294967299"));
    expect_in("material 0 has more parameters",
              refused("\"a\"", "\"a\", \"c\", \"d\", \"e\", \"f\", \"g\", \"h\", \"i\", \"j\""));
    expect_in("no JSON", refused("{", std::string(100'000, '[')));
}

}  // namespace
}  // namespace radiafit

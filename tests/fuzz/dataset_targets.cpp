// The packed dataset and the truth beside it, file by file.
#include "dataset/dataset.h"
#include "dataset/image_stream.h"
#include "dataset/mesh_ply.h"
#include "dataset/truth.h"
#include "dataset_fixture.h"
#include "target.h"

namespace radiafit::fuzz {
namespace {

using Seeds = std::vector<std::string>;

/// Three pictures of a tetrahedron, one with a mask.
void write_photographs(const fs::path& folder, Encoding encoding) {
    write_random(folder, encoding, {{5, 4, false, 1}, {3, 3, true, 1.5}, {2, 6, true, 0.5}});
}

View lit_view(int i, const Grid& grid) {
    View view;
    view.name = std::to_string(i);
    view.camera.width = grid.width;
    view.camera.height = grid.height;
    view.camera_direction = Vec3d(0, 0, 1);
    view.light.emplace();
    if (i == 1) view.light->kind = Light::Kind::near;
    return view;
}

/// A grid of 4 x 3 texels with normals, under a far and a near lamp.
void write_grid(const fs::path& folder) {
    Dataset header;
    header.name = "grid";
    header.grid = Grid::centered(4, 3, 0.5);
    header.grid.texel_normals.assign(12, Vec3f::UnitZ());
    DatasetWriter writer(folder);
    writer.set_encoding(Encoding::f32_linear);
    const std::vector<float> pixels(36, 0.25f);
    for (int i = 0; i < 2; ++i) writer.add(lit_view(i, header.grid), pixels.data(), {});
    writer.finish(header);
}

void write_relief(const fs::path& folder) {
    Dataset header;
    header.mesh = tetrahedron();
    header.normal_map.side = 3;
    header.normal_map.normals.assign(24, Vec3f::UnitZ());
    View view;
    view.name = "a";
    view.camera = Camera::look_at({3, 1, 4}, {0, 0, 0}, {0, 0, 1}, 0.7, 2, 2);
    const std::vector<uint8_t> pixels(12, 99);
    DatasetWriter writer(folder);
    writer.add(view, pixels.data(), {});
    writer.finish(header);
}

/// As a fit reads it: everything once, in both spaces.
void read_dataset(const fs::path& folder) {
    const Dataset dataset = open_dataset(folder / "set");
    for (const TargetSpace space : {TargetSpace::stored, TargetSpace::linear}) {
        ImageStream stream(dataset, StreamSource::disk, space);
        TargetImage image;
        std::vector<float> values;
        for (uint32_t view = 0; view < dataset.views.size(); ++view) {
            stream.load(view, image);
            stream.load_values(view, values);
        }
    }
}

/// As written before there were checksums: they would hide what lies behind them.
void make_older(const fs::path& json) { put_bytes(json, replaced(bytes_of(json), "\"version\": 4", "\"version\": 3")); }

/// One file of a dataset that `write` makes.
Target dataset_target(const char* name, const char* file, const std::function<void(const fs::path&)>& write) {
    const fs::path path = fs::path("set") / file, json = fs::path("set") / "dataset.json";
    const auto seeds = [=](const fs::path& folder) {
        write(folder / "set");
        Seeds seeds{bytes_of(folder / path)};
        make_older(folder / json);
        if (path == json) seeds.push_back(bytes_of(folder / json));
        return seeds;
    };
    return {name, path, seeds, read_dataset};
}

ReflectanceTruth small_truth() {
    ReflectanceTruth truth;
    truth.side = 3;
    truth.exact = true;
    truth.materials = {{"gold", "lafortune", {"a", "b", ""}}, {"clay", "oren-nayar-blinn", {}}};
    truth.material = {0, 1, 1, 0};
    truth.parameters.assign(4, {1, 2, 3, 4, 5, 6, 7, 8, 9});
    return truth;
}

Target truth_target(const char* name, const char* file) {
    const auto seeds = [=](const fs::path& folder) {
        write_truth(small_truth(), folder);
        return Seeds{bytes_of(folder / file)};
    };
    return {name, file, seeds, [](const fs::path& folder) { read_truth(folder); }};
}

Target mesh_target() {
    const auto seeds = [](const fs::path& folder) {
        write_ply(tetrahedron(), folder / "mesh.ply");
        return Seeds{bytes_of(folder / "mesh.ply")};
    };
    return {"dataset_mesh", "mesh.ply", seeds, [](const fs::path& folder) { read_ply(folder / "mesh.ply"); }};
}

}  // namespace

std::vector<Target> dataset_targets() {
    const auto photographs = [](const fs::path& folder) { write_photographs(folder, Encoding::u8_srgb); };
    const auto floats = [](const fs::path& folder) { write_photographs(folder, Encoding::f32_linear); };
    return {dataset_target("dataset_json", "dataset.json", photographs),
            dataset_target("dataset_json_grid", "dataset.json", write_grid),
            dataset_target("dataset_json_relief", "dataset.json", write_relief),
            dataset_target("dataset_images", "images.bin", floats),
            dataset_target("dataset_normals", "normals.f32", write_relief),
            dataset_target("dataset_normals_grid", "normals.f32", write_grid),
            mesh_target(),
            truth_target("truth_json", truth_json_name),
            truth_target("truth_parameters", truth_parameters_name),
            truth_target("truth_material", truth_material_name)};
}

}  // namespace radiafit::fuzz

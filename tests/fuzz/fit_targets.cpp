// The FIT folder, file by file.
#include "dataset_fixture.h"
#include "fit/fit_folder.h"
#include "fit_scene.h"
#include "image/exr.h"
#include "target.h"

namespace radiafit::fuzz {
namespace {

using Seeds = std::vector<std::string>;

/// A fit of six vertices, two terms.
void write_light_field(const fs::path& folder, bool own_sides) {
    const Dataset dataset = testing::write_dataset(folder / "set", testing::sheet_dataset(tetrahedron(), 2, 4, 1),
                                                   [](size_t, int x, int y, int) { return uint8_t(16 * x + y); });
    LightFieldFit fit = testing::random_fit(dataset, 2, ViewLookup::bilinear, 3, own_sides);
    fit.options_json = "{\"validation\": 2}";
    write_fit(folder / "fit", fit, dataset.mesh);
}

Dataset lit_grid(const fs::path& folder) {
    Dataset header;
    header.name = "grid";
    header.grid = Grid::centered(4, 3, 0.5);
    View view;
    view.name = "a";
    view.camera.width = 4;
    view.camera.height = 3;
    view.camera_direction = Vec3d(0, 0, 1);
    view.light.emplace();
    const std::vector<uint8_t> pixels(36, 77);
    DatasetWriter writer(folder);
    writer.add(view, pixels.data(), {});
    writer.finish(header);
    return open_dataset(folder);
}

void write_reflectance(const fs::path& folder, const char* model) {
    const Dataset dataset = lit_grid(folder / "set");
    const auto atlas = texel_atlas(dataset, 1);
    ReflectanceFit fit;
    fit.options.model = find_texel_model(model);
    const size_t texels = atlas->texel_count();
    fit.parameters.assign(texels * size_t(fit.options.model->parameters), 0.25f);
    fit.status.assign(texels, Status(1));
    fit.iterations.assign(texels, 7);
    fit.samples.assign(texels, 1);
    fit.error.assign(texels, 0.5f);
    set_dataset(fit, dataset);
    write_fit(folder / "fit", fit, *atlas);
}

void read_light_field(const fs::path& folder) {
    fitted_model(folder / "fit");
    read_fit(folder / "fit");
}

void read_reflectance_fit(const fs::path& folder) {
    fitted_model(folder / "fit");
    read_reflectance(folder / "fit");
}

Target fit_target(const char* name, const char* file, const std::function<void(const fs::path&)>& write,
                  const std::function<void(const fs::path&)>& read) {
    const fs::path path = fs::path("fit") / file;
    const auto seeds = [=](const fs::path& folder) {
        write(folder);
        return Seeds{bytes_of(folder / path)};
    };
    return {name, path, seeds, read};
}

Seeds any_maps(const fs::path& folder) {
    const ExrImage image{3, 2, {"B", "G", "R"}, std::vector<float>(18, 0.5f), {{"note", "a text"}}};
    Seeds seeds;
    for (const ExrType type : {ExrType::float32, ExrType::float16}) {
        write_exr(folder / "any.exr", image, type);
        seeds.push_back(bytes_of(folder / "any.exr"));
    }
    return seeds;
}

}  // namespace

std::vector<Target> fit_targets() {
    const auto lafortune = [](const fs::path& folder) { write_reflectance(folder, "lafortune"); };
    const auto one_side = [](const fs::path& folder) { write_light_field(folder, false); };
    const auto own_sides = [](const fs::path& folder) { write_light_field(folder, true); };
    const auto replacing = [](const fs::path& folder) {
        check_fit_target(folder / "fit");
        read_light_field(folder);
    };
    return {{"exr", "any.exr", any_maps, [](const fs::path& folder) { read_exr(folder / "any.exr"); }},
            fit_target("fit_json", "fit.json", one_side, replacing),
            fit_target("fit_surface_map", "surface_term0_corner0.exr", one_side, read_light_field),
            fit_target("fit_view_map", "view_term1.exr", one_side, read_light_field),
            fit_target("fit_problems", "problems.exr", one_side, read_light_field),
            fit_target("fit_sides", "sides.exr", own_sides, read_light_field),
            fit_target("fit_json_of_own_sides", "fit.json", own_sides, replacing),
            fit_target("reflectance_json", "fit.json", lafortune, read_reflectance_fit),
            fit_target("reflectance_map", "shape.exr", lafortune, read_reflectance_fit)};
}

}  // namespace radiafit::fuzz

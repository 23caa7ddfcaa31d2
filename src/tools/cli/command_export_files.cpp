// export gltf, rti, maps: what other programs read of a fit.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <span>

#include "base/choose.h"
#include "base/error.h"
#include "base/log.h"
#include "base/output_claims.h"
#include "base/read_file.h"
#include "cli/commands.h"
#include "cli/render_options.h"
#include "exchange/gltf.h"
#include "exchange/maps_json.h"
#include "exchange/relief.h"
#include "exchange/relight.h"
#include "exchange/surface_normals.h"
#include "exchange/textures.h"
#include "fitting/family.h"
#include "fitting/limits.h"
#include "image/exr.h"

namespace radiafit::tools {
namespace {

namespace fs = std::filesystem;

struct ExportOptions {
    std::string fit, dataset, output;
    bool without_maps = false;
    std::optional<int> view;
    std::optional<int> planes;  ///< of relight
    int quality = 100;
    std::string basis = "bilinear";  ///< of relight
    std::string normals;             ///< of maps; empty: as suits the fit
};

/// `check`: throws UserError for what is there and is no such output.
void add_fit_and_output(CommandLine& command, ExportOptions& o, const char* output, void (*check)(const fs::path&)) {
    command.add_text("fit", o.fit, "folder of the fit").required().input();
    command.add_text("--dataset", o.dataset, "where the dataset is now, if it moved").idle();
    command.add_text("-o,--output", o.output, output).required().idle();
    command.writes(
        [&o, check] { return std::vector{OutputTarget{.path = o.output, .check = [&o, check] { check(o.output); }}}; });
}

/// fit.json and the maps, by name.
std::vector<OwnFile> own_files(const fs::path& fit) {
    std::vector<fs::path> paths;
    for (const auto& entry : fs::directory_iterator(fit))
        if (entry.path().extension() == ".exr" || entry.path().filename() == "fit.json") paths.push_back(entry.path());
    std::ranges::sort(paths);
    std::vector<OwnFile> files;
    for (const fs::path& path : paths) files.push_back({path.filename().string(), read_file(path, "map of the fit")});
    return files;
}

void check_glb_target(const fs::path& file) {
    require_ending(file, ".glb");
    std::error_code error;
    if (fs::exists(fs::symlink_status(file, error)) && !is_our_glb(file))
        throw UserError(fmt::format("{}: is there, and is no glTF file of radiafit; choose another name or remove it",
                                    file.string()));
}

/// A folder with no other files than `names` is ours and is replaced. Throws UserError for anything else that is
/// there.
void check_folder_target(const fs::path& folder, const char* what, std::span<const char* const> names) {
    std::error_code error;
    const auto refuse = [&](const std::string& why) {
        throw UserError(fmt::format("{}: {}; remove it or choose another name", folder.string(), why));
    };
    if (!fs::exists(fs::symlink_status(folder, error))) return;
    if (!fs::is_directory(folder, error)) refuse("a file is there");
    for (const auto& entry : fs::directory_iterator(folder, error)) {
        const std::string name = entry.path().filename().string();
        if (name == made_by_name) continue;
        if (!entry.is_regular_file(error) || std::ranges::find(names, name) == names.end())
            refuse(fmt::format("holds {}, which is no part of {}", name, what));
    }
}
constexpr const char* rti_files[] = {"info.json",   "plane_0.jpg", "plane_1.jpg", "plane_2.jpg", "plane_3.jpg",
                                     "plane_4.jpg", "plane_5.jpg", "plane_6.jpg", "plane_7.jpg", "plane_8.jpg"};
constexpr const char* map_files[] = {"base_colour.png", "base_colour.exr", "roughness.png",
                                     "roughness.exr",   "normals.png",     "normals.exr",
                                     "height.png",      "height.exr",      "maps.json"};
void check_rti_target(const fs::path& folder) { check_folder_target(folder, "an RTI export", rti_files); }
void check_maps_target(const fs::path& folder) { check_folder_target(folder, "exported maps", map_files); }

void export_gltf(const ExportOptions& o) {
    check_glb_target(o.output);
    auto fit = open_fit(o.fit, o.dataset);
    const SurfaceLook look = look_of(fit);
    const auto own = o.without_maps ? std::vector<OwnFile>() : own_files(o.fit);
    const std::string bytes = glb_of(look, fit.dataset(), fitted_model(o.fit), own);
    write_file(o.output, bytes);
    log_info(fmt::format("base colour: {}", look.meaning));
    log_info(fmt::format("{}: {:.1f} MB", o.output, double(bytes.size()) / 1e6));
}

void export_rti(const ExportOptions& o) {
    AtomicFolder folder(o.output, AtomicFolder::Existing::replace);
    auto fit = open_fit(o.fit, o.dataset);
    if (!takes_light(fit))
        throw UserError(
            fmt::format("{}: its model keeps the light it was photographed under; fit a reflectance model to "
                        "images under lamps that move",
                        o.fit));
    const Dataset& dataset = fit.dataset();
    const View& view = dataset.views[chosen_view(dataset, o.view)];
    RelightOptions options{.quality = o.quality};
    options.basis = choose<RelightOptions::Basis>(
        "basis", o.basis, {{"ptm", RelightOptions::Basis::ptm}, {"bilinear", RelightOptions::Basis::bilinear}});
    if (o.planes && options.basis == RelightOptions::Basis::ptm)
        throw UserError("--planes is of --basis bilinear; a polynomial has as many as it has");
    options.planes = o.planes.value_or(options.planes);
    const Relight relight = relight_of(contestant_of(fit), dataset, view, options);
    for (size_t k = 0; k < relight.planes.size(); ++k)
        write_file(folder.path() / fmt::format("plane_{}.jpg", k), relight.planes[k]);
    write_file(folder.path() / "info.json", relight.info);
    folder.commit();
    log_info(fmt::format("{}/info.json: {} x {} pixels, {} in {} images", o.output, dataset.grid.width,
                         dataset.grid.height,
                         options.basis == RelightOptions::Basis::ptm
                             ? std::string("a polynomial texture map")
                             : fmt::format("{} components of colours under lamps", options.planes),
                         relight.planes.size()));
}

ExrImage exr_of(const TextureImage& texture, const std::vector<std::string>& channels) {
    return {texture.width, texture.height, channels, texture.values, {}};
}

enum class NormalsFrom { fit, dataset };

/// asked: none, as suits the fit: those of the dataset if a grid has others than its plane's, else of the fit if its
/// light moved, else nothing. Throws UserError where the fit is asked for what it can't tell.
std::optional<SurfaceNormals> normals_for(Fitted& fit, const SurfaceLook& look, const std::string& folder,
                                          std::optional<NormalsFrom> asked) {
    const Dataset& dataset = fit.dataset();
    if (asked.value_or(has_own_normals(dataset) ? NormalsFrom::dataset : NormalsFrom::fit) == NormalsFrom::dataset)
        return normals_of_dataset(*look.atlas, dataset);
    if (!takes_light(fit)) {
        if (!asked) return std::nullopt;
        throw UserError(
            fmt::format("{}: its model keeps the light it was photographed under, which tells no normals; choose "
                        "--normals dataset",
                        folder));
    }
    auto normals = normals_of_fit(contestant_of(fit), *look.atlas, dataset, fitted_views(dataset, fit.record()));
    if (normals) return normals;
    const auto why =
        fmt::format("{}: the lamps that were fitted, fewer than three or all in one plane, tell no normals", folder);
    if (asked) throw UserError(why + "; choose --normals dataset");
    log_info(why + ": those of the dataset are written");
    return normals_of_dataset(*look.atlas, dataset);
}

void export_maps(const ExportOptions& o) {
    std::optional<NormalsFrom> from;
    if (!o.normals.empty())
        from =
            choose<NormalsFrom>("normals", o.normals, {{"fit", NormalsFrom::fit}, {"dataset", NormalsFrom::dataset}});
    AtomicFolder folder(o.output, AtomicFolder::Existing::replace);
    auto fit = open_fit(o.fit, o.dataset);
    const Dataset& dataset = fit.dataset();
    const SurfaceLook look = look_of(fit);
    const LookTextures textures = textures_of(look, dataset);
    const std::optional<SurfaceNormals> normals = normals_for(fit, look, o.fit, from);
    std::optional<Relief> relief;
    if (normals && dataset.has_grid()) relief = relief_of(*normals, *look.atlas, dataset.grid);
    const auto write = [&](const std::string& name, const std::string& png, const TextureImage& texture,
                           const std::vector<std::string>& channels) {
        write_file(folder.path() / (name + ".png"), png);
        write_exr(folder.path() / (name + ".exr"), exr_of(texture, channels));
    };
    const bool alpha = textures.base_colour.channels == 4;
    write("base_colour", base_colour_png(textures), textures.base_colour,
          alpha ? std::vector<std::string>{"R", "G", "B", "A"} : std::vector<std::string>{"R", "G", "B"});
    if (textures.roughness) write("roughness", roughness_png(*textures.roughness), *textures.roughness, {"Y"});
    if (normals) {
        const auto texture =
            normals_texture(normals->or_else(normals_of_dataset(*look.atlas, dataset)), look, textures);
        write("normals", normals_png(texture), texture, {"x", "y", "z"});
    }
    if (relief) write("height", height_png(*relief), relief->heights, {"Y", "A"});
    write_file(folder.path() / "maps.json", maps_json(look, normals, relief, dataset.has_grid()));
    folder.commit();
    log_info(fmt::format("base colour: {}", look.meaning));
    if (normals)
        log_info("normals: " + (normals->lamps > 0 ? fmt::format("by photometric stereo on what the fit shows under {} "
                                                                 "lamps",
                                                                 normals->lamps)
                                                   : std::string("those that were fitted with")));
    log_info(fmt::format("{}: textures of {} x {} pixels", o.output, textures.base_colour.width,
                         textures.base_colour.height));
}

}  // namespace

void add_export_files(CommandLine& exporter) {
    auto o = std::make_shared<ExportOptions>();
    CommandLine& gltf = exporter.add_command("gltf", "the surface with base colour and roughness, as glTF 2.0 (GLB)");
    gltf.add_flag("--without-maps", o->without_maps, "leave out the fit's own maps, which `extras` holds otherwise");
    add_fit_and_output(gltf, *o, "file, which ends in .glb", check_glb_target);
    gltf.on_run([=] { export_gltf(*o); });

    CommandLine& rti = exporter.add_command("rti", "a grid's fit for OpenLIME, relight's viewer, as JPEG images");
    rti.add_number("--view", o->view, limits::view, "whose camera looks; in the middle of those held out if not given");
    rti.add_word("--basis", o->basis,
                 "bilinear: components of what the fit shows, between lamps on a grid; ptm: a polynomial texture map")
        .choices({"ptm", "bilinear"});
    rti.add_number("--planes", o->planes, limits::relight_planes, "of bilinear: how many components; default: 27");
    rti.add_number("--quality", o->quality, limits::jpeg_quality, "of the JPEG images");
    add_fit_and_output(rti, *o, "folder of info.json and the images", check_rti_target);
    rti.on_run([=] { export_rti(*o); });

    CommandLine& maps =
        exporter.add_command("maps", "base colour, roughness, normals and height as PNG and EXR textures");
    maps.add_word("--normals", o->normals,
                  "dataset: those that it was fitted with, the default of a grid that has some; fit: found from what "
                  "it shows under its lamps, the default elsewhere")
        .choices({"fit", "dataset"});
    add_fit_and_output(maps, *o, "folder of the textures", check_maps_target);
    maps.on_run([=] { export_maps(*o); });
}

}  // namespace radiafit::tools

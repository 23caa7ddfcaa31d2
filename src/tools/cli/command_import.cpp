// import: real captures, packed; files of RTI as fits.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include "base/log.h"
#include "base/record.h"
#include "capture/import.h"
#include "capture/import_lights.h"
#include "capture/light_doubt.h"
#include "capture/light_file.h"
#include "cli/commands.h"
#include "fitting/image_checks.h"
#include "fitting/limits.h"
#include "rti/import_rti.h"

namespace radiafit::tools {
namespace {

constexpr const char* holdout_help =
    "every:N, every:N+K, random:N, random:N:SEED, spread:N (over directions), none, or a file of image names";

/// What an import has to say, and what its dataset is.
void tell(const auto& report, const std::string& out, bool json) {
    for (const std::string& note : report.notes) log_warning(note);
    for (const std::string& remark : report.remarks) log_info(remark);
    const Dataset dataset = open_dataset(out);
    std::vector<std::string> suspicious = suspicious_images(dataset);
    if constexpr (requires { report.unlike; })  // those have been named with the reason
        std::erase_if(suspicious, [&](const std::string& name) { return std::ranges::count(report.unlike, name) > 0; });
    if (!suspicious.empty()) log_warning(describe_suspicious(suspicious));
    print_dataset(dataset, json);
}

/// A format of calibrations: all of them take the same options.
struct CalibrationFormat {
    const char *name, *help, *model_help, *images_help;
    bool images_required;
    const char* holdout;       ///< the rule by default; empty: as holdout_help says
    const char* holdout_help;  ///< behind what all formats have
    ImportReport (*import)(const ImportOptions&, const std::filesystem::path&);
};

constexpr CalibrationFormat calibration_formats[] = {
    {"colmap", "photographs with a COLMAP calibration and a mesh", "folder with cameras and images, .txt or .bin",
     "folder of the photographs, which the model calibrates", true, "every:8", "", import_colmap},
    {"transforms", "photographs with the cameras of a NeRF's transforms.json, and a mesh",
     "transforms.json or transforms_train.json, or its folder",
     "folder that its file_paths are relative to; default: its own", false, "",
     "; default: the images of transforms_test.json, without that every:8", import_transforms},
    {"llff", "photographs with LLFF's poses_bounds.npy and a mesh", "poses_bounds.npy, or its folder",
     "folder of the photographs, in the rows' order when sorted by name; default: images, beside it", false, "every:8",
     "", import_llff}};

/// Folders that are read though no option names them: of the photographs where --images doesn't, of a glTF's buffers.
std::vector<std::filesystem::path> files_beside(const ImportOptions& o) {
    std::vector<std::filesystem::path> folders;
    const auto folder_of = [](const std::filesystem::path& file) {
        return file.has_parent_path() ? file.parent_path() : std::filesystem::path(".");
    };
    if (o.images.empty()) folders.push_back(folder_of(o.model));
    if (o.mesh.extension() == ".gltf") folders.push_back(folder_of(o.mesh));
    return folders;
}

void add_calibrated(CommandLine& command, const CalibrationFormat& format) {
    auto options = std::make_shared<ImportOptions>();
    auto out = std::make_shared<std::string>();
    auto json = std::make_shared<bool>(false);
    options->holdout = format.holdout;
    CommandLine& import = command.add_command(format.name, format.help);
    import.add_text("--model", options->model, format.model_help).required().input();
    CommandOption images = import.add_text("--images", options->images, format.images_help).input();
    if (format.images_required) images.required();
    import.add_text("--mesh", options->mesh, "surface in the calibration's frame: PLY, OBJ, STL, GLB, glTF")
        .required()
        .input();
    import.add_text("--mesh-turn", options->mesh_turn,
                    "the mesh's old axes that its new x, y and z are: x,z,-y makes y of z and z of -y");
    import.add_number("--mesh-scale", options->mesh_scale, limits::mesh_scale, "of the mesh, after that");
    import.add_text("--mesh-shift", options->mesh_shift, "x,y,z that is added to the mesh, after that");
    import.add_flag("--flip-faces", options->flip_faces, "turn the mesh's faces over: they face inward");
    if (format.import == import_transforms)
        import.add_flag("--apply-transform", options->apply_transform,
                        "move the mesh as the file says that cameras were moved (applied_transform)");
    import
        .add_text("--masks", options->masks,
                  "folder of NAME.png, NAME.EXT.png, NAME_mask.png or mask_NAME.png, white = object")
        .input();
    import.add_text("--holdout,--held-out", options->holdout, std::string(holdout_help) + format.holdout_help).input();
    import.add_number("--max-size", options->max_size, limits::max_size, "longest side in pixels; 0 keeps the size");
    import
        .add_text(
            "--gains", options->gains,
            "auto: estimated where photographs need them; none, estimate, per-channel, or a table (name ... linear "
            "gain)")
        .input();
    import
        .add_word("--exif-orientation", options->exif_orientation,
                  "stored, apply, or auto: turned where only that gives the calibrated size")
        .choices({"auto", "stored", "apply"});
    import.add_number("--least-coverage", options->least_coverage, limits::least_coverage,
                      "of the masks by the mesh, without masks of the images; default: 0.2 and 0.01");
    import.add_flag("--invert-masks", options->invert_masks, "in the masks' files, black = object");
    import.add_flag("--skip-missing", options->skip_missing,
                    "go on without photographs that are calibrated but not there");
    import.add_text("--name", options->name, "of the dataset");
    import.add_text("-o,--output", *out, "folder of the packed dataset").required().idle();
    add_force(import, options->force);
    add_json(import, *json);
    import.writes([=] { return std::vector{dataset_target(*out)};
},
                  [=] {
    print_dataset(open_dataset(*out), *json); }, [=] {
    return files_beside(*options); });
    import.on_run([=] {
    const ImportReport report = format.import(*options, *out);
    tell(report, *out, *json);
    }  // namespace
);
}  // namespace radiafit::tools

void add_lights(CommandLine& command) {
    auto options = std::make_shared<LightImportOptions>();
    auto out = std::make_shared<std::string>();
    auto json = std::make_shared<bool>(false);
    CommandLine& lights = command.add_command(
        "lights", "images that show one surface pixel on pixel, under a lamp each: a fixed camera, or a flat sample");
    lights.add_text("--images", options->images, "folder of the images").required().input();
    lights.add_text("--lights", options->lights, "directions to distant lamps: x y z per line, or an RTI .lp file")
        .input();
    lights.add_text("--light-positions", options->light_positions, "in their place: where near lamps stand").input();
    lights
        .add_text("--spheres", options->spheres,
                  "in their place: lamps by their highlights on glossy spheres in the images; auto finds up to two, "
                  "auto:N up to N; or a file of circles, x y radius per line in pixels of the image files, y down")
        .input();
    lights
        .add_number("--sphere-radius", options->sphere_radius, limits::sample_width,
                    "of each of the spheres, in the unit wanted, in place of --sample-width")
        .hide_default();
    lights
        .add_number("--refine-lamps", options->refine_lamps, limits::refine_lamps,
                    "by so many degrees (standard deviation) --lights or --light-positions may be off: they are "
                    "refined, with intensities, by what the surface shows")
        .hide_default();
    lights.add_text("--light-axes", options->light_axes,
                    "the light file's axes that are x (right), y (up), z (to the camera): x,-y,z if its y points down");
    lights.add_text("--names", options->names, "image names in the order of the lights; default: the folder, sorted")
        .input();
    lights.add_flag("--by-order", options->by_order,
                    "take the folder's images, sorted by name, in the order of an .lp file's lines, whatever it names");
    lights
        .add_text("--intensities", options->intensities,
                  "linear R G B per line, one line per image or one for all: the value of a white diffuse surface "
                  "that faces the lamp, near lamps at distance 1; default: 1, or as found with the lamps")
        .input();
    lights
        .add_text("--camera-positions", options->camera_positions,
                  "x y z per line, one per image or one for all; default: far away along +z")
        .input();
    lights
        .add_number("--sample-width", options->sample_width, limits::sample_width,
                    "what an image's width covers, in the unit of the positions")
        .hide_default();
    lights.add_text("--mask", options->mask, "image, white = object").input();
    lights
        .add_text("--normals", options->normals,
                  "picture of normals: x right, y up, z towards the camera; or flat; default: computed from the images "
                  "if the lamps are distant, else flat")
        .input();
    lights.add_number("--max-size", options->max_size, limits::max_size, "longest side in pixels; 0 keeps the size");
    lights
        .add_word("--transfer", options->transfer,
                  "linear, srgb, or auto: as the file says; else srgb for 8 bits, linear for more")
        .choices({"linear", "srgb", "auto"});
    lights.add_choice("--depth", options->depth, {{"8", 8}, {"16", 16}, {"32", 32}},
                      "bits per channel that the images must have: 8, 16, 32 (floats)");
    lights.add_text("--holdout,--held-out", options->holdout, holdout_help).input();
    lights.add_text("--name", options->name, "of the dataset");
    lights.add_text("-o,--output", *out, "folder of the packed dataset").required().idle();
    add_force(lights, options->force);
    add_json(lights, *json);
    lights.writes([=] { return std::vector{dataset_target(*out)}; }, [=] { print_dataset(open_dataset(*out), *json); });
    lights.on_run([=] {
        const LightImportReport report = import_lights(*options, *out);
        const std::filesystem::path& file = options->lights.empty() ? options->light_positions : options->lights;
        tell(report, *out, *json);
        if (file.empty()) return;
        const bool named = names_images(file) && !options->by_order;
        if (const auto doubt = light_doubt(open_dataset(*out), file, named, options->light_axes)) log_warning(*doubt);
    });
}

/// What became of a file, in words.
std::string describe(const RtiImportReport& report, const std::string& out) {
    std::string text = fmt::format("{}, {} x {} pixels, as a fit of model {}; see {}", report.kind, report.width,
                                   report.height, report.model, out);
    if (report.difference > 0)
        text += fmt::format(
            ". Its functions are approximated: values, as the file has them, differ by {:.2f} of 255 (root mean square "
            "amid the lamps, {:.1f} dB)",
            255 * report.difference, -20 * std::log10(report.difference));
    return text;
}

void add_rti(CommandLine& command, const Invocation& invocation) {
    auto options = std::make_shared<RtiImportOptions>();
    auto out = std::make_shared<std::string>();
    CommandLine& rti =
        command.add_command("rti", "another program's file of RTI, as a fit: .ptm, .rti (HSH), relight's info.json");
    rti.add_text("file", options->file, "the file; of relight info.json or its folder").required().input();
    rti.add_text(
           "--dataset", options->dataset,
           "the packed images that it was made of; default: some are made of it, at the output's name with -lamps "
           "behind it")
        .input();
    rti.add_choice("--curve", options->curve, {{"srgb", ValueCurve::srgb}, {"linear", ValueCurve::linear}},
                   "of the file's values: what sRGB pictures store, or light; default: what relight's info.json says, "
                   "srgb of others");
    rti.add_text("-o,--output", *out, "folder of the fit").required().idle();
    add_force(rti, options->force);
    const auto images = [out] {
        std::filesystem::path folder = std::filesystem::path(*out).lexically_normal();
        if (!folder.has_filename()) folder = folder.parent_path();
        return folder += "-lamps";
    };
    rti.writes(
        [=] {
            std::vector<OutputTarget> targets = {fit_target(*out)};
            if (options->dataset.empty()) targets.push_back(dataset_target(images()));
            return targets;
        },
        {},
        [options] {  // relight's images stand beside what describes them
            return options->file.extension() == ".json" ? std::vector{options->file.parent_path() / "."}
                                                        : std::vector<std::filesystem::path>();
        });
    rti.on_run([=] {
        RtiImportOptions chosen = *options;
        chosen.images = images();
        chosen.provenance_json = record_json(make_record(invocation.argc, invocation.argv));
        const RtiImportReport report = import_rti(chosen, *out);
        log_info(describe(report, *out));
        if (chosen.dataset.empty())
            log_info(fmt::format("{}: images made of the file, for what needs lamps and a judgement of its storing",
                                 report.dataset.string()));
    });
}

}  // namespace radiafit::tools

void add_import(CommandLine& program, const Invocation& invocation) {
    CommandLine& command = program.add_command("import", "pack a real capture, or take another program's fit");
    for (const CalibrationFormat& format : calibration_formats) add_calibrated(command, format);
    add_lights(command);
    add_rti(command, invocation);
}

}  // namespace radiafit::tools

// import: real captures, packed.
#include <memory>

#include "app/commands.h"
#include "app/limits.h"
#include "app/options.h"
#include "base/log.h"
#include "capture/import.h"
#include "capture/import_lights.h"

namespace radiafit {
namespace {

constexpr const char* holdout_help = "every:N, none, or a file of image names";

void add_colmap(CLI::App& command) {
    auto options = std::make_shared<ImportOptions>();
    auto out = std::make_shared<std::string>();
    CLI::App* colmap = command.add_subcommand("colmap", "photographs with a COLMAP calibration and a mesh");
    add_text(*colmap, "--model", options->model, "folder with cameras and images, .txt or .bin")->required();
    add_text(*colmap, "--images", options->images, "folder of the undistorted photographs")->required();
    add_text(*colmap, "--mesh", options->mesh, "surface in the calibration's frame, PLY or OBJ")->required();
    add_text(*colmap, "--masks", options->masks, "folder of NAME.png, white = object");
    add_text(*colmap, "--holdout,--held-out", options->holdout, holdout_help);
    add_number(*colmap, "--max-size", options->max_size, limits::max_size, "longest side in pixels; 0 keeps the size");
    add_text(*colmap, "--gains", options->gains, "none, estimate, or a table (name ... linear gain)");
    add_text(*colmap, "--name", options->name, "of the dataset");
    add_text(*colmap, "-o,--output", *out, "folder of the packed dataset")->required();
    add_force(*colmap, options->force);
    colmap->callback([=] {
        const ImportReport report = import_colmap(*options, *out);
        for (const std::string& note : report.notes) log_warning(note);
        print_dataset(open_dataset(*out), false);
    });
}

void add_lights(CLI::App& command) {
    auto options = std::make_shared<LightImportOptions>();
    auto out = std::make_shared<std::string>();
    CLI::App* lights = command.add_subcommand(
        "lights", "images that show one surface pixel on pixel, under a lamp each: a fixed camera, or a flat sample");
    add_text(*lights, "--images", options->images, "folder of the images")->required();
    add_text(*lights, "--lights", options->lights, "directions to distant lamps: x y z per line, or an RTI .lp file");
    add_text(*lights, "--light-positions", options->light_positions, "in their place: where near lamps stand");
    add_text(*lights, "--names", options->names, "image names in the order of the lights; default: the folder, sorted");
    add_text(*lights, "--intensities", options->intensities,
             "linear R G B per line, one line per image or one for all: the value of a white diffuse surface "
             "that faces the lamp, near lamps at distance 1; default: 1");
    add_text(*lights, "--camera-positions", options->camera_positions,
             "x y z per line, one per image or one for all; default: far away along +z");
    add_number(*lights, "--sample-width", options->sample_width, limits::sample_width,
               "what an image's width covers, in the unit of the positions")
        ->default_str("");
    add_text(*lights, "--mask", options->mask, "image, white = object");
    add_text(*lights, "--normals", options->normals, "picture of normals: x right, y up, z towards the camera");
    lights->add_option("--transfer", options->transfer, "linear, srgb, or auto: srgb for 8 bits, else linear")
        ->capture_default_str();
    add_choice<int>(*lights, "--depth", options->depth, {{"8", 8}, {"16", 16}, {"32", 32}},
                    "bits per channel that the images must have: 8, 16, 32 (floats)");
    add_text(*lights, "--holdout,--held-out", options->holdout, holdout_help);
    add_text(*lights, "--name", options->name, "of the dataset");
    add_text(*lights, "-o,--output", *out, "folder of the packed dataset")->required();
    add_force(*lights, options->force);
    lights->callback([=] {
        const LightImportReport report = import_lights(*options, *out);
        for (const std::string& note : report.notes) log_warning(note);
        print_dataset(open_dataset(*out), false);
    });
}

}  // namespace

void add_import(CLI::App& app, const Invocation&) {
    CLI::App* command = app.add_subcommand("import", "pack a real capture");
    command->require_subcommand(1);
    add_colmap(*command);
    add_lights(*command);
}

}  // namespace radiafit

// import: real captures, packed.
#include <memory>

#include "app/commands.h"
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
    colmap->add_option("--model", options->model, "folder with cameras and images, .txt or .bin")->required();
    colmap->add_option("--images", options->images, "folder of the undistorted photographs")->required();
    colmap->add_option("--mesh", options->mesh, "surface in the calibration's frame, PLY or OBJ")->required();
    colmap->add_option("--masks", options->masks, "folder of NAME.png, white = object");
    colmap->add_option("--holdout,--held-out", options->holdout, holdout_help)->capture_default_str();
    colmap->add_option("--max-size", options->max_size, "longest side in pixels; 0 keeps the size")
        ->capture_default_str();
    colmap->add_option("--gains", options->gains, "none, estimate, or a table (name ... linear gain)")
        ->capture_default_str();
    colmap->add_option("--name", options->name, "of the dataset");
    colmap->add_option("-o,--output", *out, "folder of the packed dataset")->required();
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
    lights->add_option("--images", options->images, "folder of the images")->required();
    lights->add_option("--lights", options->lights, "directions to distant lamps: x y z per line, or an RTI .lp file");
    lights->add_option("--light-positions", options->light_positions, "in their place: where near lamps stand");
    lights->add_option("--names", options->names,
                       "image names in the order of the lights; default: the folder, sorted");
    lights->add_option("--intensities", options->intensities,
                       "linear R G B per line, one line per image or one for all: the value of a white diffuse surface "
                       "that faces the lamp, near lamps at distance 1; default: 1");
    lights->add_option("--camera-positions", options->camera_positions,
                       "x y z per line, one per image or one for all; default: far away along +z");
    lights->add_option("--sample-width", options->sample_width,
                       "what an image's width covers, in the unit of the positions");
    lights->add_option("--mask", options->mask, "image, white = object");
    lights->add_option("--normals", options->normals, "picture of normals: x right, y up, z towards the camera");
    lights->add_option("--transfer", options->transfer, "linear, srgb, or auto: srgb for 8 bits, else linear")
        ->capture_default_str();
    lights->add_option("--depth", options->depth, "bits per channel that the images must have: 8, 16, 32 (floats)");
    lights->add_option("--holdout,--held-out", options->holdout, holdout_help)->capture_default_str();
    lights->add_option("--name", options->name, "of the dataset");
    lights->add_option("-o,--output", *out, "folder of the packed dataset")->required();
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

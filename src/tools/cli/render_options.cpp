#include "cli/render_options.h"

#include <fmt/format.h>

#include <filesystem>

#include "base/error.h"
#include "cli/commands.h"
#include "cli/pictures.h"
#include "fitting/limits.h"

namespace radiafit::tools {
namespace {

/// WIDTHxHEIGHT
std::array<int, 2> parse_size(const std::string& text) {
    const size_t x = text.find('x');
    if (x == std::string::npos) throw UserError(fmt::format("size = '{}': give WIDTHxHEIGHT, such as 1280x720", text));
    return {parse_number("size", text.substr(0, x), limits::picture_side),
            parse_number("size", text.substr(x + 1), limits::picture_side)};
}

/// R,G,B or "transparent".
Background parse_background(const std::string& text) {
    Background out;
    if (text == "transparent") {
        out.transparent = true;
        return out;
    }
    const size_t first = text.find(','), second = text.find(',', first + 1);
    if (first == std::string::npos || second == std::string::npos)
        throw UserError(fmt::format("background = '{}': give R,G,B from 0 to 255, or transparent", text));
    const std::array<std::string, 3> numbers = {text.substr(0, first), text.substr(first + 1, second - first - 1),
                                                text.substr(second + 1)};
    for (size_t c = 0; c < 3; ++c) out.srgb[c] = uint8_t(parse_number("background", numbers[c], limits::srgb_byte));
    return out;
}

/// "specular" or KD,KS,EXPONENT.
SpecularEnhancement parse_enhancement(const std::string& text) {
    if (text == "specular") return {};
    const size_t first = text.find(','), second = text.find(',', first + 1);
    if (first == std::string::npos || second == std::string::npos)
        throw UserError(fmt::format("enhance = '{}': give KD,KS,EXPONENT, such as 0.4,0.7,75, or specular", text));
    const auto share = [&](const std::string& number) {
        return parse_number("enhance", number, limits::enhancement_share);
    };
    return {share(text.substr(0, first)), share(text.substr(first + 1, second - first - 1)),
            parse_number("enhance", text.substr(second + 1), limits::enhancement_exponent)};
}

}  // namespace

View RenderOptions::framed(View shown, const Dataset& dataset) const {
    if (!dataset.has_grid()) shown.camera = photograph_camera(shown);
    if (size) shown.camera = fitted_into(shown.camera, (*size)[0], (*size)[1]);
    return shown;
}

void add_render_options(CommandLine& command, RenderOptions& o) {
    command.add_text("fit", o.fit, "folder of the fit").required().input();
    command.add_number("--view", o.view, limits::view,
                       "view index; default: a held-out one. In the photograph's frame and exposure");
    command
        .add_number("--turntable", o.turntable, limits::turntable,
                    "this many views instead, around the object or to and fro, where photographs were taken, in the "
                    "exposure all photographs are brought to; over a grid the lamp moves")
        .hide_default()
        .excludes("--view");
    command.add_flag("--full-circle", o.full_circle, "the turntable goes all around, photographs or not");
    command
        .add_number("--raking", o.raking, limits::raking,
                    "degrees: pictures under a distant lamp of intensity 1 so low above the surface, say 15, from all "
                    "around, of a reflectance fit; over a grid above its plane, of a mesh above the picture")
        .excludes("--turntable");
    command.add_number("--directions", o.directions, limits::raking_directions,
                       "of raking light: how many pictures; default: 8");
    command
        .add_text("--video", o.video,
                  "FILE.mp4 or FILE.webm: the turntable, or raking light, as a film of 30 frames a second, by ffmpeg; "
                  "--output can be left out then")
        .idle();
    command.add_word("--all", o.all, "held-out or train: every such view, into a folder, each beside its photograph")
        .choices({"held-out", "train"})
        .hide_default()
        .excludes("--view")
        .excludes("--turntable")
        .excludes("--raking");
    command
        .add_numbers("--light", o.light, 3, "x y z: direction to a distant lamp of intensity 1, of a reflectance fit")
        .excludes("--raking")
        .excludes("--all");
    command
        .add("--enhance", "specular|KD,KS,EXPONENT", "",
             "specular enhancement, of a reflectance fit: KD times its colours, and highlights of KS times their "
             "luminance "
             "times the cosine between normal and half vector to the power; specular: 0.4,0.7,75",
             [&o](const std::string& text) { o.enhancement = parse_enhancement(text); })
        .excludes("--all");
    command.add("--size", "WIDTHxHEIGHT", "",
                "of a picture, which the view is scaled to fit into, or the turntable's object; not over a grid",
                [&o](const std::string& text) { o.size = parse_size(text); });
    command.add("--background", "R,G,B|transparent", "", "behind the object in PNG files and films; default: 0,0,0",
                [&o](const std::string& text) { o.background = parse_background(text); });
    command
        .add_flag("--problems", o.problems,
                  "how each texel's fit ended, its iterations, samples and error, in the atlas, of a reflectance fit")
        .excludes("--view")
        .excludes("--light")
        .excludes("--enhance")
        .excludes("--raking")
        .excludes("--turntable")
        .excludes("--all")
        .excludes("--size")
        .excludes("--background");
    command.add_text("--dataset", o.dataset, "where the dataset is now, if it moved").idle();
    add_pixel_points(command, o.pixel_points);
    command
        .add_text("-o,--output", o.output,
                  "file name without or with extension; a folder for --turntable, --raking and --all")
        .idle();
}

void check_render_output(const RenderOptions& o) {
    if (o.full_circle && o.turntable == 0)
        throw UserError("--full-circle says nothing without --turntable; add --turntable 60, say");
    if (!o.video.empty() && o.turntable == 0 && !o.raking)
        throw UserError("--video says nothing without --turntable or --raking; add --turntable 60, say");
    if (o.directions && !o.raking) throw UserError("--directions says nothing without --raking; add --raking 15, say");
    if (o.output.empty() && o.video.empty()) throw UserError("--output is required; see radiafit render --help");
    const std::filesystem::path name = picture_stem(o.output).filename();
    if (!o.makes_many() && (name.empty() || name == "." || name == ".."))
        throw UserError(fmt::format("--output {}: names a folder; name a file in it", o.output));
}

uint32_t chosen_view(const Dataset& dataset, std::optional<int> view) {
    if (view) {
        if (*view < 0 || size_t(*view) >= dataset.views.size())
            throw UserError(
                fmt::format("--view {}: {} has views 0 to {}", *view, dataset.name, dataset.views.size() - 1));
        return uint32_t(*view);
    }
    const auto held_out = dataset.split(true);
    return held_out.empty() ? 0 : held_out[held_out.size() / 2];
}

}  // namespace radiafit::tools

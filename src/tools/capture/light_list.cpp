#include "capture/light_list.h"

#include <fmt/format.h>

#include <optional>
#include <set>

#include "base/error.h"
#include "base/wording.h"
#include "capture/axes_turn.h"
#include "capture/file_names.h"
#include "capture/image_finder.h"
#include "capture/light_file.h"

namespace radiafit::tools {
namespace fs = std::filesystem;
namespace {

/// In the world's axes.
LightFile read_world_lights(const fs::path& file, const std::string& axes) {
    LightFile lights = read_lights(file);
    if (axes.empty()) return lights;
    const std::optional<Mat3d> turn = parse_axes_turn(axes);
    if (!turn)
        throw UserError(
            fmt::format("{} {}: give the file's axes that the world's x, y and z are, each axis once, such as x,-y,z",
                        option_name("light-axes"), axes));
    for (Vec3d& v : lights.vectors) v = (*turn * v).eval();
    return lights;
}

}  // namespace

void expect_entries(const fs::path& file, const char* what, size_t entries, size_t images, LightImportReport& report) {
    if (entries == 1 && images > 1)
        report.remarks.push_back(fmt::format("{}: one line, taken for all {} images", file.string(), images));
    if (entries != 1 && entries != images)
        throw UserError(fmt::format("{}: {} {}, but there are {} images: write one line per image, or one for all",
                                    file.string(), entries, what, images));
}

NamedImages list_named(const LightImportOptions& o, LightImportReport& report) {
    const fs::path lights_file = o.lights.empty() ? o.light_positions : o.lights;
    LightFile lights = lights_file.empty() ? LightFile{} : read_world_lights(lights_file, o.light_axes);
    fs::path named_by = lights_file;
    if (!lights.names.empty() && !o.names.empty())
        throw UserError(
            fmt::format("{}: names its images itself: leave {} out", lights_file.string(), option_name("names")));
    const std::vector<std::string> found = list_images(o.images);
    std::vector<std::string> names = std::move(lights.names);
    if (o.by_order) {
        if (names.empty())
            throw UserError(fmt::format("{}: names no images, which are taken by their order anyway: leave {} out",
                                        lights_file.empty() ? option_name("spheres") : lights_file.string(),
                                        option_name("by-order")));
        names.clear();
    }
    const bool listed = !names.empty() || !o.names.empty();
    if (!o.names.empty()) names = read_names(named_by = o.names);
    if (!listed) names = found;
    if (names.empty())
        throw UserError(fmt::format("{}: no images here: check {}", o.images.string(), option_name("images")));
    if (!lights_file.empty() && lights.vectors.size() != names.size())
        throw UserError(fmt::format("{}: {} lights, but {} {} {} images: write one line per image, in the same order",
                                    lights_file.string(), lights.vectors.size(),
                                    listed ? o.names.string() : o.images.string(), listed ? "names" : "holds",
                                    names.size()));
    if (found.size() > names.size())
        report.notes.push_back(fmt::format("{} images of {} are left out: {} does not name them",
                                           found.size() - names.size(), o.images.string(), named_by.string()));

    NamedImages images{std::move(names), {}, std::move(lights.vectors)};
    ImageFinder finder(o.images, named_by);
    std::set<fs::path> files;
    for (const std::string& name : images.names) {
        const std::optional<fs::path> file = finder.find(name);
        if (!file)
            throw UserError(fmt::format("{}: check {}, {}", finder.missing(name), option_name("images"),
                                        found.size() == images.names.size() && o.names.empty()
                                            ? fmt::format("or give {}, which takes its {} images in the order of their "
                                                          "own names",
                                                          option_name("by-order"), found.size())
                                            : "or take its line out"));
        images.files.push_back(o.images / *file);
        if (!files.insert(images.files.back().lexically_normal()).second)
            throw UserError(fmt::format("{}: '{}' means {}, as another line does: give images of different names",
                                        named_by.string(), name, images.files.back().string()));
    }
    for (std::string& remark : finder.remarks()) report.remarks.push_back(std::move(remark));
    if (o.by_order)
        report.remarks.push_back(
            fmt::format("{}: its lamps are those of the images in the order of their names, from "
                        "'{}' to '{}', whatever images it names",
                        lights_file.string(), images.names.front(), images.names.back()));
    return images;
}

std::vector<Vec3d> given_intensities(const LightImportOptions& o, size_t images, LightImportReport& report) {
    if (o.intensities.empty()) return {};
    const std::vector<Vec3d> list = read_intensities(o.intensities);
    expect_entries(o.intensities, "intensities", list.size(), images, report);
    std::vector<Vec3d> out;
    for (size_t i = 0; i < images; ++i) out.push_back(entry_for(list, i));
    return out;
}

std::vector<Light> given_lights(const LightImportOptions& o, const NamedImages& images,
                                const std::vector<Vec3d>& intensities) {
    std::vector<Light> lights;
    for (const Vec3d& v : images.vectors) {
        const Vec3d intensity = intensities.empty() ? Vec3d::Ones() : intensities[lights.size()];
        lights.push_back(o.lights.empty() ? Light{Light::Kind::near, v, intensity}
                                          : Light{Light::Kind::distant, v.normalized(), intensity});
    }
    return lights;
}

}  // namespace radiafit::tools

#include "capture/light_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <span>

#include "base/error.h"
#include "base/text_file.h"
#include "capture/file_names.h"
#include "geometry/light_rules.h"

namespace radiafit::tools {
namespace fs = std::filesystem;
namespace {

/// The line with its commas made blanks; tokens point into `line`.
std::vector<std::string_view> split_numbers(std::string& line) {
    std::replace(line.begin(), line.end(), ',', ' ');
    return split_tokens(line);
}

Vec3d to_vector(const TextFile& text, std::span<const std::string_view> tokens, const std::string& what) {
    if (tokens.size() != 3)
        text.fail(fmt::format("a {} takes three numbers, here are {}: correct the line", what, tokens.size()));
    Vec3d v;
    for (int i = 0; i < 3; ++i) v[i] = text.to_double(tokens[size_t(i)], what.c_str());
    return v;
}

void add_name(const TextFile& text, std::string name, std::vector<std::string>& names) {
    if (std::find(names.begin(), names.end(), name) != names.end())
        text.fail(fmt::format("image '{}' appears a second time: name every image once", name));
    names.push_back(std::move(name));
}

LightFile read_lp(const fs::path& file) {
    TextFile text(file, "RTI light file");
    std::string_view line;
    if (!text.next_entry(line)) text.fail("the file is empty: an .lp file begins with the number of its images");
    const uint64_t count = text.to_unsigned(line, "the number of images");
    LightFile lights;
    while (text.next_entry(line)) {
        const std::vector<std::string_view> tokens = split_tokens(line);
        if (tokens.size() < 4)
            text.fail("an .lp file's line takes an image's name and three numbers: correct the line");
        const auto vector = std::span(tokens).last(3);
        lights.vectors.push_back(to_vector(text, vector, "light direction"));
        check_light_vector(lights.vectors.back(), text.where());
        const auto name_end = tokens[tokens.size() - 4].end();
        add_name(text, std::string(line.begin(), name_end), lights.names);
    }
    if (lights.names.size() != count)
        throw UserError(fmt::format("{}: says {} images, but lists {}: correct its first line, or the list",
                                    file.string(), count, lights.names.size()));
    return lights;
}

}  // namespace

bool names_images(const fs::path& file) { return lower_ending(file) == ".lp"; }

LightFile read_lights(const fs::path& file) {
    if (names_images(file)) return read_lp(file);
    TextFile text(file, "list of lights");
    LightFile lights;
    for (std::string_view line; text.next_entry(line);) {
        std::string numbers(line);
        lights.vectors.push_back(to_vector(text, split_numbers(numbers), "light"));
        check_light_vector(lights.vectors.back(), text.where());
    }
    return lights;
}

std::vector<Vec3d> read_vectors(const fs::path& file, const std::string& what) {
    TextFile text(file, fmt::format("list, one {} per line", what));
    std::vector<Vec3d> vectors;
    for (std::string_view line; text.next_entry(line);) {
        std::string numbers(line);
        vectors.push_back(to_vector(text, split_numbers(numbers), what));
    }
    return vectors;
}

std::vector<Vec3d> read_intensities(const fs::path& file) {
    TextFile text(file, "list of light intensities");
    std::vector<Vec3d> intensities;
    for (std::string_view line; text.next_entry(line);) {
        std::string numbers(line);
        const std::vector<std::string_view> tokens = split_numbers(numbers);
        intensities.push_back(tokens.size() == 1 ? Vec3d::Constant(text.to_double(tokens[0], "the intensity"))
                                                 : to_vector(text, tokens, "light intensity"));
        check_intensity(intensities.back(), text.where());
    }
    return intensities;
}

std::vector<Vec3d> read_circles(const fs::path& file, int width, int height) {
    TextFile text(file, "list of circles");
    std::vector<Vec3d> circles;
    for (std::string_view line; text.next_entry(line);) {
        std::string numbers(line);
        const Vec3d c = to_vector(text, split_numbers(numbers), "circle");
        if (!(c.z() > 0)) text.fail(fmt::format("the circle's radius is {:g}: write x, y and a radius above 0", c.z()));
        const double within = 5.0 / 6 * c.z();  // its outline is looked for from there on
        if (c.x() < within || c.y() < within || c.x() > width - within || c.y() > height - within)
            text.fail(
                fmt::format("the circle at ({:g}, {:g}) of radius {:g} is not within the images' {} x {} pixels: "
                            "count them from the top left corner of the image files",
                            c.x(), c.y(), c.z(), width, height));
        for (const Vec3d& other : circles)
            if ((c - other).head<2>().norm() < std::max(c.z(), other.z()))
                text.fail(
                    fmt::format("the circle at ({:g}, {:g}) overlaps the one at ({:g}, {:g}): write each sphere "
                                "once",
                                c.x(), c.y(), other.x(), other.y()));
        circles.push_back(c);
        if (circles.size() > most_spheres) text.fail(fmt::format("more than {} circles: leave some out", most_spheres));
    }
    if (circles.empty())
        throw UserError(
            fmt::format("{}: holds no circle: write x, y and radius of one sphere per line, in pixels", file.string()));
    return circles;
}

std::vector<std::string> read_names(const fs::path& file) {
    TextFile text(file, "list of image names");
    std::vector<std::string> names;
    for (std::string_view line; text.next_entry(line);) add_name(text, std::string(line), names);
    return names;
}

}  // namespace radiafit::tools

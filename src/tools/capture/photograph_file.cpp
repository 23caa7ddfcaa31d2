#include "capture/photograph_file.h"

#include <fmt/format.h>

#include "base/error.h"
#include "base/wording.h"
#include "capture/image_set.h"
#include "image/orientation.h"

namespace radiafit::tools {
namespace {

[[noreturn]] void refuse_size(const PhotographSource& source, const std::filesystem::path& file, int width, int height,
                              int orientation) {
    const std::string sizes = fmt::format("{}: {} x {} pixels, but {} {} x {}", file.string(), width, height,
                                          source.expected_by, source.width, source.height);
    const bool swapped = width == source.height && height == source.width;
    if (orientation == 1) throw UserError(fmt::format("{}: {}", sizes, source.size_cure));
    if (swaps_sides(orientation) && (swapped || (width == source.width && height == source.height)))
        throw UserError(fmt::format("{}, and its EXIF orientation {} swaps the sides: give {} auto", sizes, orientation,
                                    option_name("exif-orientation")));
    throw UserError(
        fmt::format("{} (its EXIF orientation {} does not explain it): {}", sizes, orientation, source.size_cure));
}

void turn(ImageFile& image) {
    const auto width = size_t(image.width), height = size_t(image.height);
    image.rgb8 = turn_upright(image.rgb8, image.orientation, width, height, 3);
    image.rgb16 = turn_upright(image.rgb16, image.orientation, width, height, 3);
    image.rgb32 = turn_upright(image.rgb32, image.orientation, width, height, 3);
    image.alpha = turn_upright(image.alpha, image.orientation, width, height, 1);
    if (swaps_sides(image.orientation)) std::swap(image.width, image.height);
}

/// What of the photograph counts: the mask, less what is transparent; empty: all.
std::vector<uint8_t> counted(const PhotographFile& file) {
    std::vector<uint8_t> mask;
    if (file.mask.width == file.image.width && file.mask.height == file.image.height) mask = file.mask.values;
    return without_transparent(std::move(mask), file.image.alpha);
}

}  // namespace

PhotographFile read_photograph_file(const PhotographSource& source) {
    const auto fits = [&](int width, int height) { return width == source.width && height == source.height; };
    const auto check = [&](int width, int height) {
        // Swapped sides may be for EXIF's orientation to explain, which is not known here.
        if (!fits(width, height) && !fits(height, width)) refuse_size(source, source.image, width, height, 1);
    };
    PhotographFile file;
    file.image = read_image(source.image, true, check);
    const int stored_width = file.image.width, stored_height = file.image.height;
    const int orientation = file.image.orientation;
    const bool fits_stored = fits(stored_width, stored_height);
    const bool turns = source.exif_orientation == "apply"
                           ? orientation != 1
                           : source.exif_orientation == "auto" && !fits_stored && swaps_sides(orientation);
    const ColorReading colors = convert_colors(file.image);
    if (file.image.bits == 32) file.image.linear = true;
    file.facts = facts_of(source.name, file.image, colors, false);
    if (turns) turn(file.image);
    file.facts.turned = turns;
    if (!fits(file.image.width, file.image.height))
        refuse_size(source, source.image, file.image.width, file.image.height, orientation);

    if (!source.mask.empty()) {
        const auto stored_alike = [&](int width, int height, int to_width, int to_height) {
            return turns && swaps_sides(orientation) ? width == to_height && height == to_width
                                                     : width == to_width && height == to_height;
        };
        const auto [full_width, full_height] = source.full_size;
        const auto expected = [&](int width, int height) {
            return fits(width, height) || (width == full_width && height == full_height);
        };
        const auto as_stored = [&](int width, int height) {
            return turns && (stored_alike(width, height, source.width, source.height) ||
                             stored_alike(width, height, full_width, full_height));
        };
        file.mask = read_mask(source.mask, [&](int width, int height) {
            if (!expected(width, height) && !as_stored(width, height))
                throw UserError(
                    fmt::format("{}: {} x {} pixels, but its photograph has {} x {}: give masks of that size",
                                source.mask.string(), width, height, source.width, source.height));
        });
        if (as_stored(file.mask.width, file.mask.height)) {
            file.mask.values =
                turn_upright(file.mask.values, orientation, size_t(file.mask.width), size_t(file.mask.height), 1);
            if (swaps_sides(orientation)) std::swap(file.mask.width, file.mask.height);
        }
        if (source.inverted_mask)
            for (uint8_t& value : file.mask.values) value = static_cast<uint8_t>(255 - value);
    }
    if (file.image.bits == 32) require_finite(file.image.rgb32, counted(file), source.image, file.image.width);
    return file;
}

}  // namespace radiafit::tools

#include "cli/rendered_pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <memory>

#include "base/error.h"
#include "base/parallel.h"
#include "capture/image_finder.h"
#include "capture/picture_colors.h"
#include "image/exr.h"
#include "image/image_file.h"

namespace radiafit::tools {
namespace {

namespace fs = std::filesystem;

/// Values as the picture has them, of the view's pixels.
struct Picture {
    bool linear = false;     ///< light; else sRGB
    std::vector<float> rgb;  ///< [height][width][3]
};

/// Where the view's rectangle begins in a picture of this size. Throws UserError for one that it is no picture of.
std::array<int, 2> origin_in(const fs::path& file, int width, int height, const View& view) {
    if (width == view.camera.width && height == view.camera.height) return {0, 0};
    const auto [left, top] = view.crop_origin;
    const bool within =
        left >= 0 && top >= 0 && left + view.camera.width <= width && top + view.camera.height <= height;
    if (view.full_size[0] > 0 && width == view.full_size[0] && height == view.full_size[1] && within)
        return view.crop_origin;
    const std::string whole = view.full_size[0] > 0 ? fmt::format(", or {} x {} as the whole photograph",
                                                                  view.full_size[0], view.full_size[1])
                                                    : "";
    throw UserError(fmt::format("{}: {} x {} pixels; render {} at {} x {}{}", file.string(), width, height, view.name,
                                view.camera.width, view.camera.height, whole));
}

/// The share of each pixel that is covered, which the file's colours are multiplied by; empty: no such channel.
std::vector<float> coverage_of(const fs::path& file, const ImageFile& image) {
    if (image.bits != 32 || image.alpha.empty()) return {};
    if (std::string(image.format) == "OpenEXR")
        return read_exr(file, {"A"}, std::array{image.width, image.height}).values;
    std::vector<float> out;
    for (const uint8_t alpha : image.alpha) out.push_back(float(alpha) / 255);
    return out;
}

Picture read_picture(const fs::path& file, const View& view) {
    const auto check = [&](int width, int height) { origin_in(file, width, height, view); };
    ImageFile image = read_image(file, true, check);
    const std::vector<float> coverage = coverage_of(file, image);
    const ColorReading reading = convert_colors(image);
    Picture out;
    out.linear = image.bits == 32 || reading.kind == ColorReading::Kind::linear || (image.bits == 16 && image.linear);
    const auto [left, top] = origin_in(file, image.width, image.height, view);
    const auto value_at = [&](size_t i) {
        if (image.bits == 8) return float(image.rgb8[i]) / 255;
        return image.bits == 16 ? float(image.rgb16[i]) / 65535 : image.rgb32[i];
    };
    for (int y = 0; y < view.camera.height; ++y)
        for (int x = 0; x < view.camera.width; ++x) {
            const size_t pixel = size_t(y + top) * size_t(image.width) + size_t(x + left);
            const float covered = coverage.empty() || coverage[pixel] == 0 ? 1.0f : coverage[pixel];
            for (size_t c = 0; c < 3; ++c) out.rgb.push_back(value_at(3 * pixel + c) / covered);
        }
    return out;
}

/// Where a view's picture is: of its name as EXR, which loses nothing, or as `radiafit render` calls it, or with
/// another ending. Empty: nowhere.
fs::path picture_of(const View& view, uint32_t number, const fs::path& folder, ImageFinder& finder) {
    for (const fs::path& name :
         {fs::path(view.name).replace_extension(".exr"), fs::path(fmt::format("view{:04d}.exr", number))})
        if (fs::exists(folder / name)) return folder / name;
    const auto file = finder.find(view.name);
    return file ? folder / *file : fs::path();
}

struct PictureSet {
    std::map<std::string, Picture> of_view;  ///< by name
    bool linear = false;                     ///< all of them
};

}  // namespace

Contestant pictures_as_contestant(const Dataset& dataset, const std::vector<uint32_t>& views, const fs::path& folder) {
    if (!fs::is_directory(folder)) throw UserError(folder.string() + ": no such folder; name that of the pictures");
    ImageFinder finder(folder, dataset.folder);
    std::vector<fs::path> files;
    std::vector<std::string> missing;
    for (const uint32_t v : views) {
        files.push_back(picture_of(dataset.views[v], v, folder, finder));
        if (files.back().empty()) missing.push_back(dataset.views[v].name);
    }
    if (!missing.empty())
        throw UserError(
            fmt::format("{}: {} of {} views to be judged have no picture there, such as {}; name pictures as "
                        "the dataset's images, with any ending",
                        folder.string(), missing.size(), views.size(), missing.front()));
    std::vector<Picture> read(views.size());
    parallel_for(views.size(), 1, [&](size_t i, int) { read[i] = read_picture(files[i], dataset.views[views[i]]); });

    const auto pictures = std::make_shared<PictureSet>();
    const bool gains = std::ranges::any_of(dataset.views, [](const View& view) { return view.gain != 1; });
    pictures->linear = gains || std::ranges::all_of(read, &Picture::linear) || dataset.encoding != Encoding::u8_srgb;
    for (size_t i = 0; i < views.size(); ++i) {
        std::vector<float>& rgb = read[i].rgb;
        if (pictures->linear != read[i].linear)
            for (float& x : rgb) x = float(pictures->linear ? srgb_decode(double(x)) : srgb_encode(double(x)));
        const Gain& gain = dataset.views[views[i]].gain;
        for (size_t k = 0; k < rgb.size() && gains; ++k) rgb[k] *= float(gain[k % 3]);  // as the judge has contestants
        pictures->of_view.emplace(dataset.views[views[i]].name, std::move(read[i]));
    }
    return {[pictures](const View& view, const auto&, std::vector<float>& rgb, int) {
                rgb = pictures->of_view.at(view.name).rgb;
            },
            pictures->linear ? TargetSpace::linear : TargetSpace::stored};
}

}  // namespace radiafit::tools

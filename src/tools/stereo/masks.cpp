#include "stereo/masks.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/parallel.h"
#include "capture/mask_names.h"
#include "geometry/raster.h"
#include "image/image_file.h"
#include "image/png_file.h"
#include "stereo/output_names.h"

namespace radiafit::tools {
namespace fs = std::filesystem;
namespace {

/// Without the pixels that have one outside within `inset` rows or columns.
std::vector<uint8_t> eroded(const std::vector<uint8_t>& mask, int width, int height, int inset) {
    const auto least_along = [&](const std::vector<uint8_t>& from, int length, int lines, ptrdiff_t step,
                                 ptrdiff_t next) {
        std::vector<uint8_t> to(from.size());
        for (int line = 0; line < lines; ++line)
            for (int i = 0; i < length; ++i) {
                uint8_t least = 255;
                for (int k = i - inset; k <= i + inset; ++k)
                    least = k < 0 || k >= length ? least : std::min(least, from[size_t(line * next + k * step)]);
                to[size_t(line * next + i * step)] = least;
            }
        return to;
    };
    return least_along(least_along(mask, width, height, 1, width), height, width, width, 1);
}

}  // namespace

std::vector<fs::path> find_mask_files(const Calibration& model, const fs::path& images, const fs::path& masks) {
    if (masks.empty()) return {};
    std::vector<std::string> names;
    for (const CalibratedImage& image : model.images) names.push_back(image.name);
    return match_masks(masks, images, names).files;
}

std::vector<uint8_t> load_mask(const std::vector<fs::path>& files, size_t i, const Camera& camera) {
    if (files.empty()) return {};
    return read_mask(files[i],
                     [&](int width, int height) {
                         if (width != camera.width || height != camera.height)
                             throw UserError(
                                 fmt::format("{}: {} x {} pixels, but its photograph has {} x {}: give masks of the "
                                             "undistorted photographs",
                                             files[i].string(), width, height, camera.width, camera.height));
                     })
        .values;
}

void write_mesh_masks(const Mesh& mesh, const Calibration& model, int inset, const fs::path& out) {
    std::vector<fs::path> names;
    std::set<fs::path> different;
    for (const CalibratedImage& image : model.images) {
        names.push_back(output_name(image.name).replace_extension(".png"));
        if (!different.insert(names.back()).second)
            throw UserError(fmt::format("{}: two images would have the mask {}: rename one", model.images_file.string(),
                                        names.back().string()));
    }
    AtomicFolder folder(out);
    std::vector<Rasterizer> rasters(static_cast<size_t>(thread_count()));
    parallel_for(names.size(), 1, [&](size_t i, int worker) {
        const Camera& camera = model.images[i].camera;
        Rasterizer& raster = rasters[size_t(worker)];
        raster.draw(mesh, camera);
        std::vector<uint8_t> mask(raster.pixels().size());
        for (size_t p = 0; p < mask.size(); ++p) mask[p] = raster.pixels()[p].triangle != no_triangle ? 255 : 0;
        mask = eroded(mask, camera.width, camera.height, inset);
        std::vector<uint8_t> rgb(3 * mask.size());
        for (size_t p = 0; p < rgb.size(); ++p) rgb[p] = mask[p / 3];
        const fs::path file = folder.path() / names[i];
        fs::create_directories(file.parent_path());
        write_png(file, camera.width, camera.height, rgb);
    });
    folder.commit();
}

}  // namespace radiafit::tools

#include "capture/photographs.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.h"
#include "base/read_file.h"
#include "base/wording.h"
#include "capture/image_scale.h"
#include "capture/mask_names.h"

namespace radiafit::tools {
namespace fs = std::filesystem;
namespace {

constexpr int crop_margin = 4;      // pixels around what is seen, for bilinear look-ups and small camera changes
constexpr int largest_side = 8192;  // the rasterizer is exact up to here

void find_masks(const ImportOptions& options, std::vector<Photograph>& photographs, ImportReport& report) {
    std::vector<std::string> names;
    for (const Photograph& s : photographs) names.push_back(s.name);
    MaskNames masks = match_masks(options.masks, options.images, names);
    for (size_t i = 0; i < photographs.size(); ++i) photographs[i].mask = std::move(masks.files[i]);
    report.remarks.push_back(std::move(masks.remark));
    for (std::string& note : masks.notes) report.notes.push_back(std::move(note));
}

}  // namespace

Camera scaled_camera(Camera camera, int max_size) {
    const auto [width, height] = size_within(camera.width, camera.height, max_size);
    // Pixel coordinates run from 0 at the image's left or top edge, so they scale by the very ratio of the sizes.
    const double sx = double(width) / camera.width, sy = double(height) / camera.height;
    camera.fx *= sx, camera.cx *= sx, camera.width = width;
    camera.fy *= sy, camera.cy *= sy, camera.height = height;
    return camera;
}

std::vector<Photograph> list_photographs(const ImportOptions& options, const Calibration& calibration,
                                         const std::vector<uint8_t>& held_out, ImportReport& report) {
    if (!options.masks.empty() && !folder_exists(options.masks))
        throw UserError(
            fmt::format("{}: no such folder of masks: check {}", options.masks.string(), option_name("masks")));
    std::vector<Photograph> photographs(calibration.images.size());
    for (size_t i = 0; i < photographs.size(); ++i) {
        Photograph& photograph = photographs[i];
        photograph.name = calibration.images[i].name;
        photograph.image = calibration.images[i].file;
        photograph.calibrated = calibration.images[i].camera;
        photograph.camera = scaled_camera(photograph.calibrated, options.max_size);
        photograph.held_out = held_out[i] != 0;
        photograph.mask = calibration.images[i].mask;
        photograph.inverted_mask = options.invert_masks;
        if (std::max(photograph.camera.width, photograph.camera.height) > largest_side)
            throw UserError(fmt::format("{}: {} x {} pixels; no side may exceed {}: give {}", photograph.image.string(),
                                        photograph.camera.width, photograph.camera.height, largest_side,
                                        option_name("max-size")));
    }
    if (!options.masks.empty()) find_masks(options, photographs, report);
    return photographs;
}

LoadedPhotograph load_photograph(const Photograph& photograph, const Calibration& calibration) {
    const Camera& full = photograph.calibrated;
    const auto expect_size = [&](const fs::path& file) {
        return [&](int width, int height) {
            if (width != full.width || height != full.height)
                throw UserError(fmt::format("{}: {} x {} pixels, but {} calibrates {} x {}: {}", file.string(), width,
                                            height, calibration.cameras_file.string(), full.width, full.height,
                                            calibration.size_cure));
        };
    };
    LoadedPhotograph loaded{read_image(photograph.image, false, expect_size(photograph.image)), {}};
    if (!photograph.mask.empty()) {
        MaskFile mask = read_mask(photograph.mask, expect_size(photograph.mask));
        loaded.mask = std::move(mask.values);
        loaded.largest_mask_value = mask.largest;
        loaded.mask_of_labels = mask.labels;
        if (photograph.inverted_mask)
            for (uint8_t& value : loaded.mask) value = static_cast<uint8_t>(255 - value);
    }
    const int width = photograph.camera.width, height = photograph.camera.height;
    if (width != full.width || height != full.height) {
        loaded.image = scale_down(loaded.image, width, height);
        if (!loaded.mask.empty()) loaded.mask = scale_down_mask(loaded.mask, full.width, full.height, width, height);
    }
    const std::vector<uint8_t>& alpha = loaded.image.alpha;
    if (!alpha.empty() && loaded.mask.empty()) loaded.mask.assign(alpha.size(), 255);
    for (size_t i = 0; i < alpha.size(); ++i)
        if (alpha[i] < 128) loaded.mask[i] = 0;
    return loaded;
}

void survey(Photograph& photograph, const LoadedPhotograph& loaded, const Mesh& mesh, const GainPoints* points,
            Rasterizer& raster) {
    const Camera& camera = photograph.camera;
    raster.draw(mesh, camera);
    int x0 = camera.width, y0 = camera.height, x1 = -1, y1 = -1;
    for (int y = 0; y < camera.height; ++y)
        for (int x = 0; x < camera.width; ++x) {
            const size_t pixel = size_t(y) * size_t(camera.width) + size_t(x);
            const bool object = loaded.mask.empty() || loaded.mask[pixel];
            photograph.coverage.object += object;
            if (raster.pixels()[pixel].triangle == no_triangle) continue;
            ++photograph.coverage.mesh;
            if (!object) continue;
            ++photograph.coverage.both;
            x0 = std::min(x0, x), x1 = std::max(x1, x);
            y0 = std::min(y0, y), y1 = std::max(y1, y);
        }
    photograph.bits = loaded.image.bits;
    photograph.has_mask = !loaded.mask.empty();
    photograph.largest_mask_value = loaded.largest_mask_value;
    photograph.mask_of_labels = loaded.mask_of_labels;
    photograph.sees_mesh = photograph.coverage.mesh > 0;
    photograph.seen_in_mask = x1 >= 0;
    if (!photograph.seen_in_mask) return;
    x0 = std::max(x0 - crop_margin, 0), x1 = std::min(x1 + crop_margin, camera.width - 1);
    y0 = std::max(y0 - crop_margin, 0), y1 = std::min(y1 + crop_margin, camera.height - 1);
    photograph.crop = {x0, y0, x1 - x0 + 1, y1 - y0 + 1};
    if (points) photograph.gain_samples = points->observe(camera, raster, loaded.image, loaded.mask);
}

}  // namespace radiafit::tools

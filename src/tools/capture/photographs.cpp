#include "capture/photographs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/read_file.h"
#include "base/wording.h"
#include "capture/image_scale.h"
#include "capture/image_set.h"
#include "capture/mask_names.h"
#include "capture/photograph_file.h"
#include "capture/undistort.h"
#include "image/image_header.h"

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

/// Whether pictures of both sizes may be one picture, scaled: a factor of the sides that rounding to whole pixels
/// allows, and which no crop or undistortion comes near.
bool is_scaled(const Camera& from, int width, int height) {
    const double least = std::max((width - 1.0) / from.width, (height - 1.0) / from.height);
    const double largest = std::min((width + 1.0) / from.width, (height + 1.0) / from.height);
    const double factor = std::sqrt(double(width) / from.width * height / from.height);
    constexpr double farthest = 32;  // images_8 and more; beyond, it is another picture
    return least < largest && (factor <= 0.9 || factor >= 1.1) && factor >= 1 / farthest && factor <= farthest;
}

/// What one calibrated camera becomes.
struct LensPlan {
    const CalibratedImage* image;  ///< the first that has it
    fs::path file;                 ///< its photograph
    Camera taken, pinhole;
};

/// Prepares each camera once, by the photographs that have it.
class LensPlans {
public:
    explicit LensPlans(const Calibration& calibration) : calibration_(calibration) {}

    /// With the pose of `image`.
    LensPlan of(const CalibratedImage& image) {
        // Neighbours in the list mostly have one camera.
        auto found = std::find_if(plans_.rbegin(), plans_.rend(), [&](const LensPlan& p) { return same(image, p); });
        if (found == plans_.rend()) {
            plans_.push_back(make(image));
            found = plans_.rbegin();
        }
        LensPlan plan = *found;
        for (Camera* camera : {&plan.taken, &plan.pinhole}) {
            camera->cam_from_world_rotation = image.camera.cam_from_world_rotation;
            camera->cam_from_world_translation = image.camera.cam_from_world_translation;
        }
        return plan;
    }

    /// One line for what was done to all, and what else is worth knowing.
    void report(ImportReport& report) const {
        if (scaled_)
            report.remarks.push_back(fmt::format(
                "{}: {} x {} pixels, where {} calibrates {} x {}: intrinsics are scaled by {:.4g}{}",
                plans_[*scaled_].file.string(), plans_[*scaled_].taken.width, plans_[*scaled_].taken.height,
                calibration_.cameras_file.string(), plans_[*scaled_].image->camera.width,
                plans_[*scaled_].image->camera.height,
                double(plans_[*scaled_].taken.width) / plans_[*scaled_].image->camera.width,
                scaled_cameras_ > 1 ? fmt::format(", and so are those of {} more cameras", scaled_cameras_ - 1) : ""));
        if (!undistorted_.empty()) report.remarks.push_back(undistortion());
        report.undistortion = undistortion();
        if (most_lost_ >= 0.005)
            report.remarks.push_back(fmt::format(
                "{:.0f} % of the photograph, at its border, is beyond what lens {} can tell, and is left out",
                100 * most_lost_, most_lost_name_));
        if (most_blank_ >= 0.005)
            report.remarks.push_back(
                fmt::format("{:.0f} % of the undistorted picture shows nothing of the photograph, and is left out",
                            100 * most_blank_));
    }

private:
    static bool same(const CalibratedImage& image, const LensPlan& plan) {
        const Camera &a = image.camera, &b = plan.image->camera;
        return a.width == b.width && a.height == b.height && a.fx == b.fx && a.fy == b.fy && a.cx == b.cx &&
               a.cy == b.cy && image.lens == plan.image->lens;
    }

    LensPlan make(const CalibratedImage& image) {
        LensPlan plan{&image, image.file, image.camera, {}};
        fit_to_file(plan);
        plan.pinhole = image.lens ? undistorted(plan) : plan.taken;
        return plan;
    }

    void fit_to_file(LensPlan& plan) {
        const Camera& camera = plan.image->camera;
        const ImageHeader header = read_image_header(plan.file, read_file(plan.file, "image file"));
        const int width = int(header.width), height = int(header.height);
        // A photograph on its side may be turned when it is read; if it isn't, reading it says so.
        if ((width == camera.width && height == camera.height) || (height == camera.width && width == camera.height))
            return;
        if (is_scaled(camera, width, height))
            plan.taken = resized_camera(camera, width, height);
        else if (is_scaled(camera, height, width))
            plan.taken = resized_camera(camera, height, width);
        else
            throw UserError(
                fmt::format("{}: {} x {} pixels, but {} calibrates {} x {}: {}, or all of them scaled alike",
                            plan.file.string(), width, height, calibration_.cameras_file.string(), camera.width,
                            camera.height, calibration_.size_cure));
        if (!scaled_) scaled_ = plans_.size();
        ++scaled_cameras_;
    }

    Camera undistorted(const LensPlan& plan) {
        const Lens& lens = *plan.image->lens;
        const Camera pinhole = undistorted_camera(plan.taken, lens);
        const UndistortionLoss loss = undistortion_loss(plan.taken, lens, pinhole);
        if (loss.blank > 0.5)
            throw UserError(
                fmt::format("{}: lens {} of image '{}' folds the picture over, or leads out of it, for {:.0f} "
                            "% of its pixels: calibrate again, with fewer coefficients",
                            calibration_.cameras_file.string(), lens.name(), plan.image->name, 100 * loss.blank));
        if (undistorted_.empty())
            undistorted_ = fmt::format("undistorted from {}: {} x {} -> {} x {} pixels", lens.name(), plan.taken.width,
                                       plan.taken.height, pinhole.width, pinhole.height);
        ++lenses_;
        most_blank_ = std::max(most_blank_, loss.blank);
        if (loss.no_pinhole > most_lost_) most_lost_ = loss.no_pinhole, most_lost_name_ = lens.name();
        return pinhole;
    }

    std::string undistortion() const {
        return lenses_ > 1 ? fmt::format("{} ({} lenses, of which this is the first)", undistorted_, lenses_)
                           : undistorted_;
    }

    const Calibration& calibration_;
    std::vector<LensPlan> plans_;
    std::optional<size_t> scaled_;  // the first plan that is
    size_t scaled_cameras_ = 0, lenses_ = 0;
    std::string undistorted_, most_lost_name_;
    double most_blank_ = 0, most_lost_ = 0;
};

/// At the size of Photograph::camera. mask: of the photograph as taken, or as calibrated.
std::vector<uint8_t> fitted_mask(MaskFile mask, const Photograph& photograph) {
    const Camera& to = photograph.camera;
    if (photograph.lens)
        return undistort_mask(mask.values, mask.width, mask.height, photograph.taken, *photograph.lens, to);
    if (mask.width == to.width && mask.height == to.height) return std::move(mask.values);
    if (mask.width >= to.width && mask.height >= to.height)
        return scale_down_mask(mask.values, mask.width, mask.height, to.width, to.height);
    return undistort_mask(mask.values, mask.width, mask.height, photograph.taken, Lens("none", {}), to);
}

}  // namespace

Camera scaled_camera(const Camera& camera, int max_size) {
    const auto [width, height] = size_within(camera.width, camera.height, max_size);
    return resized_camera(camera, width, height);
}

std::vector<Photograph> list_photographs(const ImportOptions& options, const Calibration& calibration,
                                         const std::vector<uint8_t>& held_out, ImportReport& report) {
    if (!options.masks.empty() && !folder_exists(options.masks))
        throw UserError(
            fmt::format("{}: no such folder of masks: check {}", options.masks.string(), option_name("masks")));
    std::vector<Photograph> photographs(calibration.images.size());
    LensPlans plans(calibration);
    for (size_t i = 0; i < photographs.size(); ++i) {
        Photograph& photograph = photographs[i];
        photograph.name = calibration.images[i].name;
        photograph.image = calibration.images[i].file;
        photograph.held_out = held_out[i] != 0;
        photograph.exif_orientation = options.exif_orientation;
        photograph.mask = calibration.images[i].mask;
        photograph.inverted_mask = options.invert_masks;
        const LensPlan plan = plans.of(calibration.images[i]);
        photograph.taken = plan.taken;
        photograph.lens = calibration.images[i].lens;
        photograph.same_camera = plan.file;
        photograph.full_size = {calibration.images[i].camera.width, calibration.images[i].camera.height};
        photograph.calibrated = plan.pinhole;
        photograph.camera = scaled_camera(photograph.calibrated, options.max_size);
        if (std::max(photograph.camera.width, photograph.camera.height) > largest_side)
            throw UserError(fmt::format("{}: {} x {} pixels; no side may exceed {}: give {}", photograph.image.string(),
                                        photograph.camera.width, photograph.camera.height, largest_side,
                                        option_name("max-size")));
    }
    plans.report(report);
    if (!options.masks.empty()) find_masks(options, photographs, report);
    return photographs;
}

LoadedPhotograph load_photograph(const Photograph& photograph, const Calibration& calibration) {
    const Camera &taken = photograph.taken, &to = photograph.camera;
    PhotographSource source;
    source.name = photograph.name;
    source.image = photograph.image;
    source.mask = photograph.mask;
    source.inverted_mask = photograph.inverted_mask;
    source.width = taken.width, source.height = taken.height;
    source.full_size = photograph.full_size;
    source.exif_orientation = photograph.exif_orientation;
    if (taken.width != photograph.full_size[0] && photograph.image != photograph.same_camera) {
        source.expected_by = photograph.same_camera.string() + ", of the same camera, has";
        source.size_cure = "give photographs that are all scaled alike";
    } else {
        source.expected_by = calibration.cameras_file.string() + " calibrates";
        source.size_cure = calibration.size_cure + ", or all of them scaled alike";
    }
    PhotographFile file = read_photograph_file(source);
    LoadedPhotograph loaded;
    loaded.image = std::move(file.image);
    loaded.facts = std::move(file.facts);
    if (!photograph.mask.empty()) {
        loaded.largest_mask_value = file.mask.largest;
        loaded.mask_of_labels = file.mask.labels;
        loaded.mask = fitted_mask(std::move(file.mask), photograph);
    }
    std::vector<uint8_t> inside;
    if (photograph.lens) {
        UndistortedImage undistorted = undistort(loaded.image, taken, *photograph.lens, to);
        loaded.image = std::move(undistorted.image);
        inside = std::move(undistorted.inside);
    } else if (to.width != taken.width || to.height != taken.height) {
        loaded.image = scale_down(loaded.image, to.width, to.height);
    }
    loaded.has_mask = !loaded.image.alpha.empty() || !loaded.mask.empty();
    loaded.mask = without_transparent(std::move(loaded.mask), loaded.image.alpha);
    loaded.mask = without_transparent(std::move(loaded.mask), inside);
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
    photograph.linear = loaded.image.linear;
    photograph.facts = loaded.facts;
    photograph.has_mask = loaded.has_mask;
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

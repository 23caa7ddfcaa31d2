#pragma once
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "eval/metrics.h"
#include "eval/nearest_training.h"
#include "eval/pixel_areas.h"
#include "eval/truth_errors.h"

/// The judge: compares renders with photographs, and knows neither optimizer nor engine.
///
/// Foreground: pixels whose centre sees the mesh (geometry's rasterizer), or a usable texel of the grid, inside the
/// image's mask. The judge finds them; a contestant only says what colour they have, at several points of each
/// (eval/pixel_areas.h).
///
/// Exposure: a contestant's values have the exposure that the dataset's gains bring all photographs to. They are
/// compared in the photograph's own exposure and encoding:
///     clamp(encode(s decode(value))) against the photograph as stored,    s = 1 / gain,
/// so that the photograph is never touched, what it clipped is clipped in the render too, and no choice of gains can
/// raise a figure by making the photographs darker. A held-out view's exposure is not known to anyone: if any gain in
/// the dataset differs from 1, the judge takes the s that suits the render best (least squared error), for every
/// contestant alike, and reports 1 / s as the view's gain; where any view has a gain per channel, an s for each
/// channel. Where all gains are 1, s = 1 throughout.
namespace radiafit {

enum class Split { train, test, validation };
std::string to_string(Split split);

/// A photograph and its render, ready to be compared or shown. [height][width][3], stored encoding, in [0, 1].
struct JudgedView {
    int width = 0, height = 0;
    std::vector<float> photograph;
    std::vector<float> render;        ///< in the photograph's exposure; NaN where not finite; 0 outside the foreground
    std::vector<uint8_t> foreground;  ///< [height][width]
    Gain gain;                        ///< 1 / s: linear, from the photograph's exposure to the contestant's
    std::vector<uint8_t> missing = {};  ///< [height][width]: inside the image's mask, where the mesh is not; or empty
};

struct ImageFigures {
    std::string name;
    uint64_t pixels = 0;  ///< foreground
    Gain gain;
    double share_of_fit = 1;     ///< Contestant's
    double outside = 0;          ///< by how much (radians) it lies outside the training views' directions
    ErrorSums stored, linear;    ///< in the stored encoding; in linear light
    SsimSum ssim;                ///< where it was asked for
    ErrorBarFigures error_bars;  ///< where the contestant has some
    ErrorSums missing;           ///< stored: of pixels inside the mask that the mesh lacks, which a render leaves black
    ErrorsByAngle by_angle;      ///< stored: where it was asked for
};

/// Parts of the surface, such as materials, whose errors are reported separately as well.
struct SurfaceParts {
    std::vector<std::string> names;
    std::function<size_t(const RasterPixel& pixel)> of;  ///< index into names; none: no parts
};
struct PartFigures {
    std::string name;
    ErrorSums stored;
};

struct JudgeOptions {
    const SurfaceParts* parts = nullptr;
    int pixel_points = as_photographed;  ///< PixelAreas'
    bool ssim = false;                   ///< structural similarity as well (eval/ssim.h)
    /// Errors by the angle to the nearest training image as well (eval/nearest_training.h); not of training views.
    bool by_angle = false;
    std::function<void()> judged = {};  ///< after each image, of any thread
};

struct JudgeResult {
    Split split = Split::test;
    int pixel_points = 0;              ///< that it came to: PixelAreas::points()
    std::vector<ImageFigures> images;  ///< in dataset order
    ErrorSums stored, linear;          ///< pooled over all images
    SsimSum ssim;                      ///< pooled over all windows
    ErrorBarFigures error_bars;        ///< pooled, where the contestant has some
    std::vector<PartFigures> parts;    ///< pooled, if parts were asked for
    /// Of the images that lie inside the cone of the training views' directions (dataset/view_directions.h), and
    /// outside by a degree or more: what the fit interpolates, and what it extrapolates.
    ErrorSums inside, outside;
    size_t outside_count = 0;  ///< images
    ErrorsByAngle by_angle;    ///< pooled, where it was asked for; else without values
    /// Pooled: what the mesh lacks of the images' masks, where the mesh is not but the mask is.
    ErrorSums missing;
    double missing_share() const {
        return missing.values ? double(missing.values) / double(missing.values + stored.values) : 0;
    }
    ErrorSums with_missing() const {
        ErrorSums sum = stored;
        sum.add(missing);
        return sum;
    }
    double psnr() const { return stored.psnr(); }
    double ape() const { return stored.ape(); }
};

/// Validation: the views held out of a dataset that app's for_validation() made. Throws UserError if the split has no
/// view, or no view of it has a foreground pixel.
JudgeResult judge(const Contestant& contestant, const Dataset& dataset, Split split, const JudgeOptions& options = {});

/// Views one by one, as judge() compares them. The dataset must outlive it.
class ViewJudge {
public:
    explicit ViewJudge(const Dataset& dataset, int pixel_points = as_photographed);
    /// worker: as Contestant's. Throws UserError for a view that is none.
    JudgedView compare(const Contestant& contestant, uint32_t view, int worker = 0) {
        return compare_(contestant, view, worker);
    }

private:
    std::function<JudgedView(const Contestant&, uint32_t, int)> compare_;
};

/// Throws UserError where there are no errors, as the views of a split have no foreground.
void check_foreground(const ErrorSums& pooled, const Dataset& dataset, Split split);
/// Differences of all of a view's foreground, in the stored encoding: between its render, or photograph, and another's.
ErrorSums differences(std::span<const float> a, std::span<const float> b, std::span<const uint8_t> foreground);
inline ErrorSums errors_of(const JudgedView& judged) {
    return differences(judged.render, judged.photograph, judged.foreground);
}

/// Another method's figures on the same views.
struct JudgedBeside {
    std::string name, words;  ///< at the command line; in texts
    JudgeResult result;
};

/// One JSON object: psnr, ape, psnr_linear, ape_linear, ssim, split, pixel_points, images, pixels, not_finite,
/// per_image
/// [{name, psnr, ape, psnr_linear, ape_linear, baseline_psnr, pixels, gain, degrees_outside}], inside and outside
/// {images, psnr, ape}, by_angle [{degrees [from, to], pixels, share, psnr, ape}] and unseen {pixels, share, psnr, ape}
/// where they were asked for, error_bars {within, doubtful, psnr_sound, psnr_doubtful} where the contestant has some,
/// missing_share and psnr_with_missing (of the masks' pixels that the mesh lacks), parts [{name, psnr, ape, pixels}] if
/// any, outliers [names] (eval/outliers.h), and, if given, baseline {psnr, ape, psnr_linear, ape_linear, parts} and
/// beside {name: {psnr, ape, psnr_linear, ape_linear}}. A figure that is not finite is null. truth, if any:
/// [{name, texels, rmse, worst_median, worst_90, median {parameter: error}, within,
/// within_each {parameter: {values, share}}}], the latter five where comparable, the last two with error bars.
std::string judge_json(const JudgeResult& result, const JudgeResult* baseline = nullptr,
                       std::span<const MaterialErrors> truth = {}, std::span<const JudgedBeside> beside = {});

}  // namespace radiafit

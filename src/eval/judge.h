#pragma once
#include <functional>
#include <string>
#include <vector>

#include "dataset/dataset.h"
#include "dataset/image_stream.h"
#include "eval/metrics.h"
#include "fit/fit_folder.h"
#include "geometry/raster.h"

/// The judge: compares renders with photographs, and knows neither optimizer nor engine.
///
/// Foreground: pixels whose centre sees the mesh (geometry's rasterizer) inside the image's mask. The judge finds
/// them; a contestant only says what colour they have.
///
/// Exposure: a contestant's values have the exposure that the dataset's gains bring all photographs to. They are
/// compared in the photograph's own exposure and encoding:
///     clamp(encode(s decode(value))) against the photograph as stored,    s = 1 / gain,
/// so that the photograph is never touched, what it clipped is clipped in the render too, and no choice of gains can
/// raise a figure by making the photographs darker. A held-out view's exposure is not known to anyone: if any gain in
/// the dataset differs from 1, the judge takes the s that suits the render best (least squared error), for every
/// contestant alike, and reports 1 / s as the view's gain. Where all gains are 1, s = 1 throughout.
namespace radiafit {

enum class Split { train, test };
std::string to_string(Split split);

/// Anything that can colour the pixels of a camera: rgb [height][width][3] out, at `pixels` that see the mesh (others
/// don't matter). `worker` is parallel_for's: calls with different workers may run at once.
struct Contestant {
    std::function<void(const Camera& camera, const std::vector<RasterPixel>& pixels, std::vector<float>& rgb,
                       int worker)>
        shade;
    TargetSpace space = TargetSpace::stored;  ///< of the values it hands out
};

/// A photograph and its render, ready to be compared or shown. [height][width][3], stored encoding, in [0, 1].
struct JudgedView {
    int width = 0, height = 0;
    std::vector<float> photograph;
    std::vector<float> render;        ///< in the photograph's exposure; NaN where not finite; 0 outside the foreground
    std::vector<uint8_t> foreground;  ///< [height][width]
    double gain = 1;                  ///< 1 / s: linear, from the photograph's exposure to the contestant's
};

struct ImageFigures {
    std::string name;
    uint64_t pixels = 0;  ///< foreground
    double gain = 1;
    ErrorSums stored, linear;  ///< in the stored encoding; in linear light
};

struct JudgeResult {
    Split split = Split::test;
    std::vector<ImageFigures> images;  ///< in dataset order
    ErrorSums stored, linear;          ///< pooled over all images
    double psnr() const { return stored.psnr(); }
    double ape() const { return stored.ape(); }
};

/// Throws UserError if the split has no view, or no view of it has a foreground pixel.
JudgeResult judge(const Contestant& contestant, const Dataset& dataset, Split split);
/// The fit must be of this dataset's mesh: open_fitted_dataset() makes sure.
JudgeResult judge(const LightFieldFit& fit, const Dataset& dataset, Split split);

/// One view, as judge() compares it.
JudgedView judged_view(const Contestant& contestant, const Dataset& dataset, uint32_t view);
JudgedView judged_view(const LightFieldFit& fit, const Dataset& dataset, uint32_t view);

/// One JSON object: psnr, ape, psnr_linear, ape_linear, split, images, pixels, not_finite, per_image [{name, psnr, ape,
/// psnr_linear, ape_linear, pixels, gain}] and, if given, baseline {psnr, ape, psnr_linear, ape_linear}. A figure that
/// is not finite is null.
std::string judge_json(const JudgeResult& result, const JudgeResult* baseline = nullptr);

}  // namespace radiafit

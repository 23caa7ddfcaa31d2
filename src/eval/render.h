#pragma once
#include <filesystem>
#include <vector>

#include "eval/judge.h"
#include "fit/fit_folder.h"

/// Pictures of a fit: for viewers (linear light, EXR) and for the eye (bytes; the program writes them as PNG).
namespace radiafit {

/// [height][width], row 0 on top. rgb: linear light, unclamped, times the coverage, as image files have it
/// (premultiplied).
struct LightImage {
    int width = 0, height = 0;
    std::vector<float> rgb;       ///< [height][width][3]
    std::vector<float> coverage;  ///< [height][width]: share of the pixel that sees the mesh
};

/// What `view` (any, not only the dataset's) sees, in the exposure that the dataset's gains bring all photographs to.
/// pixel_points: PixelAreas'.
LightImage render(const Contestant& contestant, const Dataset& dataset, const View& view,
                  int pixel_points = as_photographed);

/// Stands in render's EXR and SVG files: by it the next run tells its pictures from those of others.
inline constexpr const char* picture_mark = "radiafit_render";

/// Channels R, G, B (linear light) and A (coverage), float32, and the mark. Throws UserError when the file cannot be
/// written.
void write_light_exr(const std::filesystem::path& path, const LightImage& image);

struct ByteImage {
    int width = 0, height = 0;
    std::vector<uint8_t> rgb;  ///< [height][width][3], sRGB
};

/// sRGB bytes of linear light, clamped; what is not finite is magenta.
ByteImage to_bytes(const LightImage& image);

/// One row: the photograph, the baseline (if given), the fit, and the fit's |error| in the stored encoding times
/// `error_factor`; a white line between them. Outside the foreground, render and error are black.
ByteImage comparison_sheet(const JudgedView& fit, const JudgedView* baseline, Encoding encoding,
                           float error_factor = 4);

}  // namespace radiafit

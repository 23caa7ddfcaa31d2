#pragma once
#include <array>
#include <cstdint>
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
/// pixel_points: PixelAreas'; worker: as Contestant's.
LightImage render(const Contestant& contestant, const Dataset& dataset, const View& view,
                  int pixel_points = as_photographed, int worker = 0);

/// As a photograph of that gain shows it.
LightImage in_exposure(LightImage image, const Gain& gain);

/// The view's camera with the whole photograph as its picture, of which a dataset stores a rectangle; or the view's
/// camera as it is, where that rectangle does not lie in a photograph of at most 8192 pixels a side.
Camera photograph_camera(const View& view);
/// The camera's picture scaled to fit into width x height, in its middle.
Camera fitted_into(const Camera& camera, int width, int height);

/// A mark in the files that render writes, by which the next run recognizes them.
inline constexpr const char* picture_mark = "radiafit_render";
/// The mark, and behind it which command made the file (base/made_by.h), if one is running. Letters, digits and _.
std::string picture_remark();

/// Channels R, G, B (linear light) and A (coverage), float32, and the mark. Throws UserError when the file cannot be
/// written.
void write_light_exr(const std::filesystem::path& path, const LightImage& image);

struct ByteImage {
    int width = 0, height = 0;
    std::vector<uint8_t> rgb;  ///< [height][width][channels], sRGB
    int channels = 3;          ///< 4: and alpha, with which the colours are not multiplied
};

/// What is behind the object.
struct Background {
    std::array<uint8_t, 3> srgb = {0, 0, 0};
    bool transparent = false;
};

/// sRGB bytes of linear light, clamped; what is not finite is magenta. At an outline, object and background mix in
/// linear light.
ByteImage to_bytes(const LightImage& image, const Background& background = {});

/// One row: the photograph, the baseline (if given), the fit, and the fit's |error| in the stored encoding times
/// `error_factor`; a white line between them. Outside the foreground, render and error are black.
ByteImage comparison_sheet(const JudgedView& fit, const JudgedView* baseline, Encoding encoding,
                           float error_factor = 4);

}  // namespace radiafit

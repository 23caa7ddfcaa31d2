#pragma once
#include <array>
#include <string>
#include <vector>

#include "eval/contestant.h"

/// Images under lamps that move in the format of relight and OpenLIME ("RTI for the web"): info.json, and JPEG images
/// of the coefficients of a polynomial texture map.
namespace radiafit::tools {

inline constexpr int relight_planes = 6;  ///< 1, x, y, x^2, x y, y^2 of the lamp's direction

struct Relight {
    std::string info;                                ///< info.json
    std::array<std::string, relight_planes> planes;  ///< plane_0.jpg, …: one coefficient's red, green and blue
};

/// What a viewer computes is what it shows, without a transfer function in between: the polynomial is of sRGB values.
/// So `contestant` is shown under distant lamps of intensity 1 over the whole hemisphere, and of what it shows, as
/// sRGB, the nearest polynomial is taken: least squares, each lamp weighted by how much of the fit it shows, and a
/// little even where that is nothing, so that the polynomial does not go astray there. x runs right over the grid, y
/// up.
///
/// A value is stored in an image as the byte 255 (value / scale + bias), with the scale and bias of each coefficient
/// and channel that lose least, by rounding and by what lies beyond.
///
/// view: whose camera is asked, of a dataset with a grid. Throws UserError for one without.
Relight relight_of(const Contestant& contestant, const Dataset& dataset, const View& view, int quality);

}  // namespace radiafit::tools

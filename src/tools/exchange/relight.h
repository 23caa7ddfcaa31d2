#pragma once
#include <string>
#include <vector>

#include "base/range.h"
#include "eval/contestant.h"

namespace radiafit::limits {
constexpr Range<int> relight_planes{3, 27, "in steps of 3"};
}  // namespace radiafit::limits

/// Images under lamps that move in the format of relight and OpenLIME ("RTI for the web"): info.json, and JPEG images
/// of the coefficients of functions of the lamp's direction.
namespace radiafit::tools {

struct Relight {
    std::string info;                 ///< info.json
    std::vector<std::string> planes;  ///< plane_0.jpg, ...: three coefficients each, as red, green and blue
};

struct RelightOptions {
    /// ptm: a polynomial texture map, six coefficients a channel, of 1, x, y, x^2, x y, y^2 of the lamp's direction.
    /// bilinear: `planes` principal components of colours under lamps, which the viewer interpolates between lamps that
    /// lie on a grid over the hemisphere (its octahedral map).
    enum class Basis { ptm, bilinear };
    Basis basis = Basis::ptm;
    int planes = 27;
    int quality = 100;  ///< of JPEG
};

/// What a viewer computes is what it shows, without a transfer function in between: functions are of sRGB values. So
/// `contestant` is shown under distant lamps of intensity 1 over the whole hemisphere, and of what it shows, as sRGB,
/// the nearest sum of functions is taken: least squares, each lamp weighted by how much of the fit it shows, and a
/// little even where that is nothing, so that the functions do not go astray there. x runs right over the grid, y up.
///
/// A value is stored in an image as the byte 255 (value / scale + bias), with the scale and bias of each coefficient
/// that lose least, by rounding and by what lies beyond.
///
/// view: whose camera is asked, of a dataset with a grid. Throws UserError for one without, and for planes out of
/// range.
Relight relight_of(const Contestant& contestant, const Dataset& dataset, const View& view,
                   const RelightOptions& options);

}  // namespace radiafit::tools

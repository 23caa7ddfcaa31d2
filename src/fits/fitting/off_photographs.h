#pragma once
#include <functional>
#include <vector>

#include "dataset/dataset.h"
#include "eval/metrics.h"
#include "fitting/fit_request.h"

/// How models do far from the photographs that they were fitted to: what a visitor sees who walks around an object on
/// paths that no photographer took.
namespace radiafit::fits {

/// Some views, and what has to be left out of a fit so that it knows nothing within an angle of each.
struct FarViews {
    std::vector<uint32_t> judged;  ///< ascending
    std::vector<uint32_t> fitted;  ///< ascending; at least `degrees` from each of the judged ones
};
/// Of these views, up to `most` that lie far apart, such that no more than half of all views lie within so many degrees
/// of one of them: cameras' directions from the surface's centre, or lamps', whichever differ more. None are judged
/// where all would have too many neighbours. The same for the same input.
FarViews far_views(const Dataset& dataset, const std::vector<uint32_t>& views, double degrees, size_t most = 6);
/// The dataset with the fitted ones alone to fit, and the judged ones held out.
Dataset split_by(const Dataset& dataset, const FarViews& far);

struct OffPhotographs {
    double degrees = 0;  ///< at least, from every fitted view
    size_t views = 0, fitted = 0;
    ErrorSums fit, baseline;  ///< pooled, of stored values; the baseline's of the same fitted views
    double worst = 0;         ///< dB: of an image, its PSNR less the baseline's, where that is least
};
inline constexpr double off_degrees[] = {15, 25, 35};

/// Fits anew what was fitted, for each of off_degrees without the views around some, and judges these. Angles for which
/// there are no such views are left out. judged: after each. Throws UserError where none is left, and for a fit that
/// was made in parts, as these are made whole.
std::vector<OffPhotographs> judge_off_photographs(const Dataset& dataset, const FitRecord& fit, int pixel_points,
                                                  const std::function<void(const OffPhotographs&)>& judged = {});

}  // namespace radiafit::fits

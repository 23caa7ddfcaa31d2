#pragma once
#include <optional>
#include <string>
#include <vector>

#include "base/rings.h"
#include "dataset/dataset.h"

/// What small fits say of a dataset's images, before anything is fitted in earnest.
namespace radiafit::fits {

/// Training images that the simplest model, a mean colour per texel of a coarse lattice over the mesh, where lamps move
/// a Lambertian fit, misses by far more than the others (eval/outliers.h). None where it cannot be fitted, takes
/// more than half of the free memory, or has too few images to say so.
std::vector<std::string> suspicious_images(const Dataset& dataset);
/// One line for people that names them and the cure; empty if there are none.
std::string describe_suspicious(const std::vector<std::string>& names);

/// By which share the gains of a dataset under light that stays lower the root mean square error of every eighth
/// training photograph, predicted by a small view basis that is fitted to the others.
struct GainBenefit {
    double lowered = 0;                            ///< against no gains; below 0: it is higher
    std::optional<double> lowered_by_one_for_all;  ///< the same of one gain per photograph, where channels differ
};
/// None where no gain differs from 1, or where that cannot be said, as above.
std::optional<GainBenefit> gain_benefit(const Dataset& dataset);
/// "gains are needed: they lower the error of photographs left out by 12 %", or that they are not.
std::string describe_gains(const GainBenefit& benefit);

}  // namespace radiafit::fits

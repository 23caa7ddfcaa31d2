#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "capture/gains.h"
#include "dataset/dataset.h"

/// Whether gains are needed: whether they explain how photographs differ better than the view does, as gloss has it.
namespace radiafit::tools {

/// Samples of photographs, and where these were taken.
struct GainScene {
    const GainPoints& points;
    std::vector<Vec3d> eyes;                       ///< [views]
    std::vector<std::vector<GainSample>> samples;  ///< [views]
    std::vector<uint8_t> held_out;                 ///< [views]
};

/// A gain of every photograph.
struct KnownGains {
    std::vector<Gain> gains;
    std::vector<size_t> guessed = {};  ///< as in GainEstimate
};
/// How gains are come by, from samples alone.
using GainRule = std::function<KnownGains(const std::vector<std::vector<GainSample>>& samples)>;

/// By which share gains lower the error of photographs that are left out.
///
/// Each training photograph is predicted at each point from the others that show it, by a Gaussian process over the
/// directions to the cameras: a logarithm that changes smoothly with the view, as gloss has it. How smoothly is what
/// suits each side of the comparison best, from lobes of some degrees to no change at all.
///
/// Gains are found on one half of the surface and judged on the other: a change of exposure is the same on both, gloss
/// is not. Halves are taken along each of three axes, so that their normals differ. Without gains, a factor common to
/// all points that changes smoothly with the view, as the other photographs' gains predict it, is tried as well. The
/// error is the mean absolute one of the channels' logarithms.
struct GainBenefit {
    double lowered = 0;                      ///< against no gains; below 0: it is higher
    std::optional<double> lowered_by_other;  ///< the same of the other rule, if there is one

    bool needed() const { return lowered >= least_needed; }
    /// What gloss explains that is much alike over the surface, where photographs are far apart, is less: 8 % at most
    /// on the twelve made captures by which this bound was chosen (tests/capture/gain_benefit_test.cpp), where
    /// exposures in thirds of a stop explain half and more. It judged twelve others rightly, of another lamp, pattern
    /// and gloss, and of exposures within half a stop. Of the gold cape gains explain 11 %, which is close.
    static constexpr double least_needed = 0.1;
    static constexpr double least = 0.01;  ///< another rule's, to be told
};

/// None where fewer than three training photographs share points on both
/// halves of the surface.
std::optional<GainBenefit> gain_benefit(const GainScene& scene, const GainRule& rule, const GainRule* other = nullptr);

/// "they lower the error of photographs left out by 12 %".
std::string describe_lowered(double lowered, bool would);

}  // namespace radiafit::tools

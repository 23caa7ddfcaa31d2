#pragma once
#include <vector>

#include "lamps/sphere_lamps.h"
#include "lamps/surface_samples.h"

/// How bright lamps are, and where, from the surface that they light.
namespace radiafit::tools {

struct RefinedLamps {
    std::vector<CalibratedLamp> lamps;  ///< as they were given, moved; [images]
    /// [images] per channel: the irradiance at the world's origin of a surface that faces the lamp. Their geometric
    /// mean over the images is 1: what is common to all lamps cannot be told from the surface's own colour.
    std::vector<Vec3d> strengths;
    std::vector<Vec3d> deviations;  ///< standard deviations of the strengths, as shares of them
};

/// Each pixel is diffuse, of a normal and a colour of its own, which are found as well: the least squares of
///     value = strength_lamp (irradiance direction_lamp) . (colour normal)
/// over all pixels and lamps and of the lamps off where they were said to be, by Gauss-Newton steps in which the
/// pixels' unknowns are eliminated (Schur complement). Places by the channels' mean, then strengths channel by channel.
/// Shadows are left out, and what lies far off counts less (Cauchy's loss). Deviations are those of a sandwich
/// estimator over patches, which holds where neighbours err together. covariance: as of SphereLamps; empty: places are
/// held. Throws UserError where the pixels are too few or too dark.
RefinedLamps refine_lamps(const std::vector<CalibratedLamp>& lamps, const Eigen::MatrixXd& covariance,
                          const SurfaceSamples& samples);

/// The light's intensity that makes such an irradiance at the world's origin.
Vec3d intensity_of(const Light& lamp, const Vec3d& strength);

}  // namespace radiafit::tools

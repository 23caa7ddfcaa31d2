#pragma once
#include <memory>
#include <vector>

#include "eval/error_bars.h"
#include "fit/texel_fit.h"
#include "lightbasis/light_basis_fit.h"
#include "lightbasis/solve_light_basis.h"

namespace radiafit::fits {

/// How far noise in the photographs moves a light basis fit, given the basis, and the model underneath where there is
/// one: what prior and samples leave open of a texel's z has the covariance s^2 (Phi' Phi + noise I)^-1, with Phi the
/// functions at the samples and s^2 the texel's mean squared residual over 3 samples - trace((Phi' Phi + noise I)^-1
/// Phi' Phi) (Rasmussen and Williams 2006, section 2.1).
class LightErrorBars {
public:
    LightErrorBars(const LightBasisFit& fit, const Atlas& atlas, const TexelSource& source,
                   const TexelLightReader& reader);

    std::vector<float> deviation;     ///< [texels][rank] of z; 0 without samples
    std::vector<float> noise;         ///< [texels] s, on the curve
    std::vector<uint32_t> deficient;  ///< [texels] functions of which the samples say less than the prior

    /// Standard deviations of the value under a lamp (directions in the basis' frame), per channel, on the curve.
    /// solver: the caller's, of this fit's basis, for what neighbouring texels have in common.
    Vec3f of_value(uint32_t texel, size_t block, const LampAndHalf& at, LightBasisSolver& solver) const;

private:
    std::vector<std::shared_ptr<const std::vector<LampAndHalf>>> from_;  ///< [texels] how its samples are lit and seen
};

/// As write_error_bars() of fit/texel_fit.h.
void write_error_bars(const std::filesystem::path& folder, const Atlas& atlas, const LightBasisFit& fit,
                      const LightErrorBars& bars);

}  // namespace radiafit::fits

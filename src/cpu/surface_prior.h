#pragma once
#include <optional>
#include <span>
#include <vector>

#include "cpu/texel_solver.h"
#include "geometry/atlas.h"

namespace radiafit {

/// What is known of a texel's parameters before it is seen: those of the texels around it. Independent Gaussians, about
/// the medians of a block of the surface, as wide as all texels scatter about their blocks' (empirical Bayes: Efron,
/// Large-Scale Inference, 2010, chapter 1).
struct SurfacePrior {
    size_t parameters = 0;           ///< of the model
    std::vector<float> means;        ///< [blocks][parameters]
    std::vector<uint32_t> block_of;  ///< [texels]; of those that aren't usable 0
    /// [basis, then shape] variance of a residual over the parameters' own: what a parameter's squared distance from
    /// its mean counts for beside squared residuals.
    std::vector<double> weights;

    std::span<const float> mean_of(uint32_t texel) const { return {&means[block_of[texel] * parameters], parameters}; }
};

/// Learned from a fit without it, by texels that it determines well. None where these are few.
std::optional<SurfacePrior> learn_surface_prior(const TexelModel& model, const Atlas& atlas, const TexelResult& fit);

/// Levenberg-Marquardt without the prior, and again with it for texels that few samples tell of, fewer than
/// enough_samples for each column of the Jacobian, or that the first fit calls underdetermined; these keep that status.
/// Iterations are those of both fits, the trace is the first one's. progress: of the first.
TexelResult solve_lm_with_surface(const TexelProblem& problem, const Atlas& atlas, const TexelFitOptions& fit,
                                  const std::function<void()>& progress);
inline constexpr uint32_t enough_samples = 4;

}  // namespace radiafit

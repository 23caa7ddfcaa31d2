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
    /// [basis, then shape] variance of a residual over that of the parameter: what a parameter's squared distance
    /// from its mean counts for beside squared residuals.
    std::vector<double> weights;

    std::span<const float> mean_of(uint32_t texel) const { return {&means[block_of[texel] * parameters], parameters}; }
    /// The prior of these texels alone, numbered anew in their order.
    SurfacePrior of(std::span<const uint32_t> texels) const;
};

/// Learned from a fit without a prior, by the texels that it determines well. None where these are few.
std::optional<SurfacePrior> learn_surface_prior(const TexelModel& model, const Atlas& atlas, const TexelResult& fit);

/// Whether the prior is used for a texel that a fit without it left in this state: with fewer samples than
/// enough_samples for each column of the Jacobian, or underdetermined.
bool poorly_seen(const TexelModel& model, Status status, uint32_t samples);
inline constexpr uint32_t enough_samples = 4;
/// All such texels of the fit, ascending.
std::vector<uint32_t> poorly_seen(const TexelModel& model, const TexelResult& fit);

/// Fits these texels anew with the prior, by Levenberg-Marquardt, and puts them into `fit`, which is one of all texels:
/// those that are underdetermined there keep that status, iterations are those of both fits, and the trace stays.
/// problem: its source has the samples of these texels alone, in their order; its loader is of the atlas.
void fit_with_prior(const SurfacePrior& prior, const TexelProblem& problem, const std::vector<uint32_t>& texels,
                    const TexelFitOptions& options, TexelResult& fit);

/// Levenberg-Marquardt without the prior, and for poorly seen texels again with it. progress: of the first fit.
TexelResult solve_lm_with_surface(const TexelProblem& problem, const Atlas& atlas, const TexelFitOptions& fit,
                                  const std::function<void()>& progress);

}  // namespace radiafit

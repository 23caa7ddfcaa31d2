#pragma once
#include <array>
#include <span>
#include <vector>

#include "base/rings.h"
#include "model/status.h"
#include "model/texel_local.h"
#include "samples/texel_loader.h"

namespace radiafit::fits {

struct CeresTexelOptions {
    enum class Method {
        whole,      ///< Ceres' trust region over all parameters
        projected,  ///< over the shape alone: variable projection by hand, with Kaufman's Jacobian
        tiny        ///< ceres::TinySolver over all parameters, without Ceres' problems and allocations
    } method = Method::whole;
    enum class Linear { dense_qr, dense_normal_cholesky } linear = Linear::dense_normal_cholesky;
    int iterations = 50;
    double tolerance = 1e-6;      ///< of the cost's relative change: TexelFitOptions'
    double initial_radius = 1e4;  ///< of the trust region
};

template <class Text>
struct CeresTexelOutcome {
    typename TexelLocal<Text>::Parameters parameters;  ///< canonical gauge
    double error = 0;                                  ///< E = 1/2 sum w r^2
    int iterations = 0;
    Status status = Status::no_samples;
};

/// Ceres on one texel of a texel-local model: one residual block of all samples and channels, the parameters in one
/// block within the model's bounds, the Jacobian from the shared text. TinySolver knows no bounds: beyond them its
/// model stays as it is at the bound. `Text`: texel_text::NAME<double>. From `start`, which must be within bounds.
template <class Text>
CeresTexelOutcome<Text> ceres_texel(std::span<const TexelSample<Text::term_count>> samples,
                                    const typename TexelLocal<Text>::Parameters& start,
                                    const CeresTexelOptions& options);

/// The same for a model by its name and samples as they come from a dataset; start [model.parameters].
struct CeresTexelFit {
    std::vector<float> parameters;  ///< canonical gauge
    double error = 0;
    int iterations = 0;
    Status status = Status::no_samples;
};
CeresTexelFit ceres_texel(const TexelModel& model, std::span<const ShadedSample> samples, std::span<const float> start,
                          const CeresTexelOptions& options);

}  // namespace radiafit::fits

#pragma once
#include <array>
#include <memory>
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
        tiny,       ///< ceres::TinySolver over all parameters, without Ceres' problems and allocations
        tiny_pack   ///< the same in 32-bit floats, eight samples side by side
    } method = Method::whole;
    /// The normal equations are the quicker ones here, with the same errors (`make bench`).
    enum class Linear { dense_qr, dense_normal_cholesky } linear = Linear::dense_normal_cholesky;
    int iterations = 50;
    double tolerance = 1e-6;      ///< of the cost's relative change: TexelFitOptions'
    double initial_radius = 1e4;  ///< of the trust region
};

/// Models of more parameters a texel are linear, and Levenberg-Marquardt on the CPU is done with them after one step:
/// not worth the time that Ceres' solvers of so many take to compile.
constexpr int most_ceres_parameters = 18;

template <class Text>
struct CeresTexelOutcome {
    typename TexelLocal<Text>::Parameters parameters;  ///< canonical gauge
    double error = 0;                                  ///< E = 1/2 sum w r^2
    int iterations = 0;
    Status status = Status::no_samples;
};

/// Ceres on the texels of a texel-local model, one after another: one residual block of all samples and channels, the
/// parameters in one block within the model's bounds, the Jacobian from the shared text. TinySolver knows no bounds:
/// beyond them its model stays as it is at the bound. Problems and memory are used again. `Text`:
/// texel_text::NAME<double>.
template <class Text>
class CeresTexels {
public:
    using Samples = std::span<const TexelSample<Text::term_count>>;
    using Parameters = typename TexelLocal<Text>::Parameters;
    virtual ~CeresTexels() = default;
    /// From `start`, which must be within bounds.
    CeresTexelOutcome<Text> solve(Samples samples, const Parameters& start);

private:
    virtual CeresTexelOutcome<Text> solve_some(Samples samples, const Parameters& start) = 0;  ///< in any gauge
};
template <class Text>
std::unique_ptr<CeresTexels<Text>> ceres_texels(const CeresTexelOptions& options);

/// The same for a model by its name and samples as they come from a dataset; start [model.parameters].
struct CeresTexelFit {
    std::vector<float> parameters;  ///< canonical gauge
    double error = 0;
    int iterations = 0;
    Status status = Status::no_samples;
};
class CeresTexelSolver {
public:
    virtual ~CeresTexelSolver() = default;
    virtual CeresTexelFit solve(std::span<const ShadedSample> samples, std::span<const float> start) = 0;
};
/// Throws std::invalid_argument for a model of more than most_ceres_parameters, and for one that there isn't.
std::unique_ptr<CeresTexelSolver> ceres_texel_solver(const TexelModel& model, const CeresTexelOptions& options);

}  // namespace radiafit::fits

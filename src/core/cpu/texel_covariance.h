#pragma once
#include <span>
#include <vector>

#include "cpu/texel_solver.h"
#include "model/covariance.h"

/// Error bars of fitted texels, whichever solver they are from: how far noise in the photographs moves a fit's
/// parameters, and the colours that it shows.
namespace radiafit {

/// Error bars of one fitted texel.
struct TexelErrorBars {
    Covariance covariance;  ///< of the parameters
    double noise = 0;       ///< standard deviation of a sample's residual, per channel; in units of the targets
    uint32_t samples = 0;
};

/// p: a fit's parameters in the canonical gauge. Noise may differ from sample to sample, as in photographs, whose
/// bright pixels vary more than dark ones: (J^T J)^-1 (sum over residuals of r^2 / (1 - h) j j^T) (J^T J)^-1, with j
/// the Jacobian's row and h the residual's leverage j^T (J^T J)^-1 j (White 1980; HC2 of MacKinnon and White 1985). It
/// is sigma^2 (J^T J)^-1 where all noise is alike. A robust loss of influence psi(r) has psi for r, over the mean of
/// psi' (Huber, Robust Statistics, 1981, section 7.6). Nothing is known of texels whose samples have no more values
/// than there are parameters: noise 0, every direction deficient.
TexelErrorBars texel_error_bars(const TexelModel& model, std::span<const float> p,
                                std::span<const ShadedSample> samples, const Loss& loss);

/// The same of all texels; parameters [texels][model.parameters].
class AllErrorBars {
public:
    AllErrorBars(const TexelProblem& problem, std::span<const float> parameters);

    std::vector<float> deviation;     ///< [texels][model.parameters]: Covariance's; 0 without samples
    std::vector<float> noise;         ///< [texels]
    std::vector<uint32_t> deficient;  ///< [texels]

    /// Standard deviations, of what a texel's fit says its colour is: [channel], per unit of irradiance. u, v: as
    /// TexelModel's; p: its parameters, as they were given. 0 without samples.
    std::array<float, 3> of_value(uint32_t texel, std::span<const float> p, const Vec3f& u, const Vec3f& v) const;

private:
    size_t triangle_size() const;

    const TexelModel* model_;
    std::vector<float> triangles_;  ///< [texels][n (n + 1) / 2] covariances' lower triangles, row by row
};

}  // namespace radiafit

#pragma once
#include <array>
#include <span>
#include <vector>

#include "cpu/vertex_problem.h"
#include "model/arrow_matrix.h"

/// Error bars of light field maps, whichever solver they are from: how far noise in the photographs moves a vertex's
/// surface maps and view map, and the colours that they show.
namespace radiafit {

/// Error bars of one of a vertex's problems, a channel.
///
/// A pixel's noise of standard deviation sigma moves the target L t by Lambda sigma. With J the Jacobian at the
/// optimum, W the samples' weights, and smoothness and active bounds taken as what is known beforehand, of curvature P
/// in the sum over samples, H = J^T W J + P, and the covariance is
///     H^-1 (sigma^2 J^T W Lambda^2 W J + s^2 P) H^-1,    s^2 the mean square of a residual,
/// which is s^2 H^-1 where all samples are as noisy, and sigma^2 (J^T J)^-1 where nothing is known beforehand. A robust
/// loss of influence psi(r) has psi for r, and the mean of psi' times J^T W J in H.
///
/// Gauge: the maps g M, h M^-T of any invertible K x K matrix M show the same colours. Of all these, changes count
/// that leave the view map's inner products with itself as they are: dh orthogonal to h X for every X. What M may be
/// is in the surface maps' covariance.
struct ProblemErrorBars {
    /// Blocks: the surface maps, [texel][term] each; the corner: the view map, [view texel][term].
    ArrowMatrix covariance;
    /// [texels of surface maps, then of the view map][term] standard deviations; infinite where undetermined.
    std::vector<float> deviation;
    /// sigma: standard deviation of a pixel, in units of the targets; 0 where samples are no more than what they
    /// determine.
    double noise = 0;
    int deficient = 0;  ///< directions that neither samples nor penalties determine
};
/// x: the vertex's block in LfmLayout's order, a lane per channel. Needs a sample.
ProblemErrorBars problem_error_bars(const VertexProblem& problem, std::span<const Lanes<float>> x, int channel);

/// A parameter whose variance is more than this times what it would be were all others known (Montgomery, Peck and
/// Vining, Introduction to Linear Regression Analysis, section 3.10) counts as undetermined.
inline constexpr double most_inflation = 1e6;

/// The same of all vertices.
class AllVertexErrorBars {
public:
    /// eyes: camera centres that of_value() is asked for. All arguments but `parameters` and `eyes` must outlive it.
    AllVertexErrorBars(const Dataset& dataset, const TriangleAtlas& atlas, const VertexRings& rings,
                       const SampleList& samples, const LfmOptions& options, std::span<const float> parameters,
                       std::span<const Vec3d> eyes);

    std::vector<float> deviation;     ///< LfmLayout's order: infinite where undetermined; 0 without samples
    std::vector<float> noise;         ///< [3 vertices]: ProblemErrorBars'
    std::vector<uint32_t> deficient;  ///< [3 vertices]

    /// Deviation of the colour that a texel shows an eye, per channel: the sum of its three vertices' standard
    /// deviations, as noise moves all three alike: their targets are parts of the same pixels.
    /// Infinite where the samples don't determine it.
    Vec3f of_value(size_t eye, uint32_t triangle, uint32_t local) const;
    /// Standard deviation of a photograph's pixel there.
    Vec3f noise_at(uint32_t triangle, uint32_t local) const;

private:
    void take(size_t v, const VertexProblem& problem, std::span<const Lanes<float>> x, int channel);
    size_t texels() const { return layout_.size() / layout_.stride(); }

    const TriangleAtlas* atlas_;
    LfmOptions options_;
    LfmLayout layout_;
    std::vector<Frame> frames_;
    std::vector<Vec3d> eyes_;
    std::vector<float> values_;  ///< [eyes][texels of all maps in the layout's order][3]
};

}  // namespace radiafit

#pragma once
#include <Eigen/Cholesky>
#include <memory>

#include "base/journal.h"
#include "lightbasis/texel_lights.h"

namespace radiafit::fits {

struct LightBasisSolution {
    std::vector<float> parameters;  ///< z: [texels][rank]; 0 where nothing was seen, which is the mean
    std::vector<uint32_t> samples;  ///< [texels]
    std::vector<float> error;       ///< [texels] 1/2 sum r^2, on the curve

    LightBasisSolution(size_t texels, int rank) : parameters(texels * size_t(rank)), samples(texels), error(texels) {}
};

/// For every texel the z of least
///     sum over samples and channels of (y_c - mean_c(l) - sum over j of z_j function_jc(l))^2 + noise |z|^2,
/// which is the mean of what prior and samples say of z, by Cholesky's decomposition. `journal` keeps texels that are
/// finished.
LightBasisSolution solve_light_basis(const Atlas& atlas, const TexelSource& source, const TexelLightReader& reader,
                                     const LightBasis& basis, Journal* journal = nullptr);

/// The same by compute shaders of the current context, each texel with a matrix of its own; it keeps nothing.
LightBasisSolution solve_on_device(const Atlas& atlas, const TexelSource& source, const TexelLightReader& reader,
                                   const LightBasis& basis);

/// Solves one texel after another; those that are lit as the last one was share its matrix.
class LightBasisSolver {
public:
    /// The basis must outlive it.
    explicit LightBasisSolver(const LightBasis& basis);  ///< one for each thread; copies share what they can
    /// Returns 1/2 sum r^2. z: [rank] out.
    float solve(size_t block, const TexelLights& lights, std::span<float> z);

    /// Texels that are lit so, whatever their values: the functions' matrix Phi at the samples, and its factors.
    void look_from(size_t block, const std::vector<LampAndHalf>& directions);
    // Of texels that are lit as was last looked from, with A = Phi' Phi + noise I:
    double determined();                        ///< trace(A^-1 Phi' Phi), by which samples determine z
    uint32_t deficient();                       ///< directions of z that they determine less than the prior does
    const Eigen::VectorXf& deviation();         ///< [rank] square roots of A^-1's diagonal
    Vec3f deviation_at(const LampAndHalf& at);  ///< the same of the three channels' values under a lamp

private:
    void find_accuracy();

    const LightBasis* basis_;
    std::shared_ptr<const LampFunctions> at_samples_;
    size_t block_ = SIZE_MAX;
    std::vector<LampAndHalf> directions_;
    Eigen::MatrixXf mean_, functions_;  ///< [3 samples], [3 samples][rank]: at the samples, channel by channel
    Eigen::MatrixXd matrix_;
    Eigen::LLT<Eigen::MatrixXd> cholesky_;
    bool accuracy_known_ = false;  ///< of those that follow
    Eigen::VectorXf deviation_;
    double determined_ = 0;
    uint32_t deficient_ = 0;
};

}  // namespace radiafit::fits

#pragma once
#include <Eigen/Core>
#include <cmath>
#include <optional>
#include <vector>

#include "basis/basis_blocks.h"
#include "geometry/mesh.h"
#include "model/prelude.h"
#include "model/value_curve.h"

/// Colours of a texel under lamps that move: functions of the lamp's direction l,
///     y_c(l) = k(l) . (mean_c + sum over j < rank of z_j function_jc),
/// where y is light over the lamp's irradiance, on a curve; mean and functions are values under reference lamps, those
/// that were photographed or some of them; and k interpolates between these as a Gaussian process does. Mean and
/// functions are learned over the surface, block by block, the three channels joint, so that z ~ N(0, I) (empirical
/// Bayes): a texel's few numbers say most of what its neighbourhood does under any lamp, cast shadows and
/// interreflections included.
namespace radiafit::fits {

/// shaders/model/light_kernel.glsl.
template <class scalar>
struct LightText {
    using real = scalar;
    using real3 = shared_text::real3_t<real>;
    static real exp(real a) { return std::exp(a); }
#include "model/light_kernel.glsl"
};
double light_kernel(const Vec3f& a, const Vec3f& b, double length);

inline constexpr int most_reference_lamps = 100;

/// Numbers of each block: [3 lamps][1 + rank]: the mean, then the functions, as columns; rows channel by channel.
struct LightBasis : BasisBlocks {
    int rank = 27;
    float noise = 0;  ///< variance of a residual
    ValueCurve curve = ValueCurve::srgb;
    Vec3f white = Vec3f::Ones();  ///< light of which the curve's 1 is: a white surface's that faces the mean lamp
    Vec3f up = Vec3f::UnitY();
    std::optional<Frame> frame = {};  ///< that directions are in; none: each texel's view_frame()
    std::vector<Vec3f> lamps = {};    ///< unit directions of the reference lamps
    float length = 0.5f;              ///< of light_kernel()
    float smoothing = 0.01f;          ///< of what is shown: variance of noise, where the kernel's is 1

    using Block = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    size_t rows() const { return 3 * lamps.size(); }
    size_t block_size() const { return rows() * size_t(1 + rank); }
    auto block(size_t i) const { return Block::Map(&numbers[i * block_size()], Eigen::Index(rows()), 1 + rank); }

    /// A value of the model, of light under so much irradiance, and the other way round.
    Vec3f value_of(const Vec3f& light, const Vec3f& irradiance) const;
    Vec3f light_of(const Vec3f& value, const Vec3f& irradiance) const;
    Frame frame_of(const Vec3f& normal) const;
};

/// (K + s I)^-1 of the kernel between the reference lamps: its product with the kernel at l is the k(l) above.
Eigen::MatrixXd lamp_weights(const std::vector<Vec3f>& lamps, double length, double s);
/// s where samples are fitted: next to nothing, so that values under reference lamps are what is photographed there.
/// What is shown between them takes the basis' smoothing.
inline constexpr double sample_smoothing = 1e-3;

/// A basis as sums of kernels at the reference lamps, with such an s.
class LampFunctions {
public:
    LampFunctions(const LightBasis& basis, double s);
    Eigen::VectorXf kernel(const Vec3f& direction) const;
    /// What the kernels are multiplied by: [3 lamps][1 + rank], as LightBasis::block().
    const LightBasis::Block& block(size_t i) const { return blocks_[i]; }
    /// The mean and the functions at a direction: [channel][1 + rank].
    Eigen::Matrix<float, 3, Eigen::Dynamic> at(size_t block, const Vec3f& direction) const;

private:
    std::vector<Vec3f> lamps_;
    float length_;
    std::vector<LightBasis::Block> blocks_;
};

}  // namespace radiafit::fits

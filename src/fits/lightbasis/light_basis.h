#pragma once
#include <Eigen/Core>
#include <algorithm>
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
/// interreflections included. Where cameras move, too, and that matters, l is the lamp's direction and the half vector.
namespace radiafit::fits {

/// How a texel is lit and seen: unit directions in one frame, to the lamp and half way to the camera, around which
/// highlights lie (Rusinkiewicz 1998).
struct LampAndHalf {
    Vec3f lamp;
    Vec3f half = Vec3f::Zero();  ///< 0: it makes no difference
    bool operator==(const LampAndHalf&) const = default;
};

/// shaders/model/light_kernel.glsl.
template <class scalar>
struct LightText {
    using real = scalar;
    using real3 = shared_text::real3_t<real>;
    static real exp(real a) { return std::exp(a); }
    static real sqrt(real a) { return std::sqrt(a); }
    static real max(real a, real b) { return std::max(a, b); }
    static real3 of(const Vec3f& v) { return {real(v.x()), real(v.y()), real(v.z())}; }
#include "model/light_kernel.glsl"
};

/// The covariance between two values, 3 of one with itself.
template <class real>
struct LightKernel {
    real length = real(0.5);     ///< over which values change with the lamp: a chord of the unit sphere
    real half_length = real(0);  ///< the same of the half vector; 0: it makes no difference
    real half_share = real(0);   ///< of the variance that changes with the half vector
    real operator()(const LampAndHalf& a, const LampAndHalf& b) const {
        using Text = LightText<real>;
        if (!(half_length > 0)) return Text::light_kernel(Text::of(a.lamp), Text::of(b.lamp), length);
        return Text::light_pair_kernel(Text::of(a.lamp), Text::of(a.half), Text::of(b.lamp), Text::of(b.half), length,
                                       half_length, half_share);
    }
};

inline constexpr int most_reference_lamps = 100;

/// Numbers of each block: [3 lamps][1 + rank]: the mean, then the functions, as columns; rows channel by channel.
struct LightBasis : BasisBlocks {
    int rank = 54;
    float noise = 0;  ///< variance of a residual
    ValueCurve curve = ValueCurve::srgb;
    Vec3f white = Vec3f::Ones();  ///< light of which the curve's 1 is: a white surface's that faces the mean lamp
    Vec3f up = Vec3f::UnitY();
    std::optional<Frame> frame = {};      ///< that directions are in; none: each texel's view_frame()
    std::vector<LampAndHalf> lamps = {};  ///< the reference lamps
    float length = 0.5f;                  ///< of the kernel
    float half_length = 0, half_share = 0;
    float smoothing = 0.01f;  ///< of what is shown: variance of noise, where the kernel's is 1

    using Block = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    size_t rows() const { return 3 * lamps.size(); }
    size_t block_size() const { return rows() * size_t(1 + rank); }
    auto block(size_t i) const { return Block::Map(&numbers[i * block_size()], Eigen::Index(rows()), 1 + rank); }

    /// A value of the model, of light under so much irradiance, and the other way round.
    Vec3f value_of(const Vec3f& light, const Vec3f& irradiance) const;
    Vec3f light_of(const Vec3f& value, const Vec3f& irradiance) const;
    Frame frame_of(const Vec3f& normal) const;
    bool by_half() const { return half_length > 0; }
    /// What it knows of directions to a lamp and a camera, all in its frame.
    LampAndHalf directions_of(const Vec3f& lamp, const Vec3f& camera) const;
};

/// (K + s I)^-1 of the kernel between the reference lamps: its product with the kernel at l is the k(l) above.
Eigen::MatrixXd lamp_weights(const std::vector<LampAndHalf>& lamps, const LightKernel<double>& kernel, double s);
/// s where samples are fitted: next to nothing, so that values under reference lamps are what is photographed there.
/// What is shown between them takes the basis' smoothing.
inline constexpr double sample_smoothing = 1e-3;

/// A basis as sums of kernels at the reference lamps, with such an s.
class LampFunctions {
public:
    LampFunctions(const LightBasis& basis, double s);
    Eigen::VectorXf kernel(const LampAndHalf& at) const;
    /// What the kernels are multiplied by: [3 lamps][1 + rank], as LightBasis::block().
    const LightBasis::Block& block(size_t i) const { return blocks_[i]; }
    /// The mean and the functions under a lamp: [channel][1 + rank].
    Eigen::Matrix<float, 3, Eigen::Dynamic> at(size_t block, const LampAndHalf& at) const;

private:
    std::vector<LampAndHalf> lamps_;
    LightKernel<float> kernel_;
    std::vector<LightBasis::Block> blocks_;
};

}  // namespace radiafit::fits

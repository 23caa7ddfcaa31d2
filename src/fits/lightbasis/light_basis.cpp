#include "lightbasis/light_basis.h"

#include "base/decompositions.h"
#include "viewbasis/texel_views.h"

namespace radiafit::fits {

Eigen::MatrixXd lamp_weights(const std::vector<LampAndHalf>& lamps, const LightKernel<double>& kernel, double s) {
    const auto n = Eigen::Index(lamps.size());
    Eigen::MatrixXd covariance = s * Eigen::MatrixXd::Identity(n, n);
    for (Eigen::Index i = 0; i < n; ++i)
        for (Eigen::Index j = 0; j < n; ++j) covariance(i, j) += kernel(lamps[size_t(i)], lamps[size_t(j)]);
    return inverse_of_definite(covariance);
}

LampFunctions::LampFunctions(const LightBasis& basis, double s)
    : lamps_(basis.lamps), kernel_{basis.length, basis.half_length, basis.half_share} {
    const Eigen::MatrixXd weights =
        lamp_weights(basis.lamps, {double(basis.length), double(basis.half_length), double(basis.half_share)}, s);
    const Eigen::Index n = weights.rows();
    for (size_t b = 0; b < basis.cubes.size(); ++b) {
        const auto values = basis.block(b).cast<double>();
        blocks_.emplace_back(values.rows(), values.cols());
        for (int c = 0; c < 3; ++c)
            blocks_.back().middleRows(c * n, n) = (weights * values.middleRows(c * n, n)).cast<float>();
    }
}

Eigen::VectorXf LampFunctions::kernel(const LampAndHalf& at) const {
    Eigen::VectorXf out(Eigen::Index(lamps_.size()));
    for (size_t i = 0; i < lamps_.size(); ++i) out[Eigen::Index(i)] = kernel_(lamps_[i], at);
    return out;
}

Eigen::Matrix<float, 3, Eigen::Dynamic> LampFunctions::at(size_t block, const LampAndHalf& at) const {
    const Eigen::VectorXf k = kernel(at);
    const LightBasis::Block& numbers = blocks_[block];
    Eigen::Matrix<float, 3, Eigen::Dynamic> out(3, numbers.cols());
    for (int c = 0; c < 3; ++c) out.row(c).noalias() = k.transpose() * numbers.middleRows(c * k.size(), k.size());
    return out;
}

Vec3f LightBasis::value_of(const Vec3f& light, const Vec3f& irradiance) const {
    Vec3f relative = Vec3f::Zero();  // where a lamp sends no light of a colour, nothing is known of it
    for (int c = 0; c < 3; ++c)
        if (irradiance[c] > 0) relative[c] = light[c] / irradiance[c] * white[c];
    return on_curve(curve, relative);
}

Vec3f LightBasis::light_of(const Vec3f& value, const Vec3f& irradiance) const {
    return from_curve(curve, value).cwiseProduct(irradiance).cwiseQuotient(white);
}

LampAndHalf LightBasis::directions_of(const Vec3f& lamp, const Vec3f& camera) const {
    if (!by_half()) return {lamp};
    using Text = LightText<float>;
    const Text::real3 half = Text::half_vector(Text::of(lamp), Text::of(camera));
    return {lamp, {half.x, half.y, half.z}};
}

Frame LightBasis::frame_of(const Vec3f& normal) const { return frame ? *frame : view_frame(normal, up); }

}  // namespace radiafit::fits

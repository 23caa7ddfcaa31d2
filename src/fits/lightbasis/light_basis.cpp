#include "lightbasis/light_basis.h"

#include <Eigen/Cholesky>

#include "viewbasis/texel_views.h"

namespace radiafit::fits {

double light_kernel(const Vec3f& a, const Vec3f& b, double length) {
    const Vec3d x = a.cast<double>(), y = b.cast<double>();
    return LightText<double>::light_kernel({x.x(), x.y(), x.z()}, {y.x(), y.y(), y.z()}, length);
}

Eigen::MatrixXd lamp_weights(const std::vector<Vec3f>& lamps, double length, double s) {
    const auto n = Eigen::Index(lamps.size());
    Eigen::MatrixXd covariance = s * Eigen::MatrixXd::Identity(n, n);
    for (Eigen::Index i = 0; i < n; ++i)
        for (Eigen::Index j = 0; j < n; ++j)
            covariance(i, j) += light_kernel(lamps[size_t(i)], lamps[size_t(j)], length);
    return covariance.llt().solve(Eigen::MatrixXd::Identity(n, n));
}

LampFunctions::LampFunctions(const LightBasis& basis, double s) : lamps_(basis.lamps), length_(basis.length) {
    const Eigen::MatrixXd weights = lamp_weights(basis.lamps, double(basis.length), s);
    const Eigen::Index n = weights.rows();
    for (size_t b = 0; b < basis.cubes.size(); ++b) {
        const auto values = basis.block(b).cast<double>();
        blocks_.emplace_back(values.rows(), values.cols());
        for (int c = 0; c < 3; ++c)
            blocks_.back().middleRows(c * n, n) = (weights * values.middleRows(c * n, n)).cast<float>();
    }
}

Eigen::VectorXf LampFunctions::kernel(const Vec3f& direction) const {
    Eigen::VectorXf out(Eigen::Index(lamps_.size()));
    for (size_t i = 0; i < lamps_.size(); ++i) {
        const Vec3f& lamp = lamps_[i];
        out[Eigen::Index(i)] = LightText<float>::light_kernel({lamp.x(), lamp.y(), lamp.z()},
                                                              {direction.x(), direction.y(), direction.z()}, length_);
    }
    return out;
}

Eigen::Matrix<float, 3, Eigen::Dynamic> LampFunctions::at(size_t block, const Vec3f& direction) const {
    const Eigen::VectorXf k = kernel(direction);
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

Frame LightBasis::frame_of(const Vec3f& normal) const { return frame ? *frame : view_frame(normal, up); }

}  // namespace radiafit::fits

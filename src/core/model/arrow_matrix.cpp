#include "model/arrow_matrix.h"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <cmath>

#include "model/covariance.h"

namespace radiafit {
namespace {

using Eigen::MatrixXd, Eigen::VectorXd;

/// Units in which the diagonal is 1.
VectorXd units_of(const MatrixXd& m) {
    return m.diagonal().unaryExpr([](double x) { return x > 0 ? 1 / std::sqrt(x) : 1.0; });
}

/// The inverse of a matrix in units in which its diagonal was 1 before others were eliminated; adds to `deficient` the
/// number of pivots that hardly exceed what was added to the diagonal.
MatrixXd inverse_of(const MatrixXd& scaled, int& deficient) {
    const Eigen::LLT<MatrixXd> factor(scaled);
    constexpr double told = 1e3 * least_curvature;
    const VectorXd diagonal = factor.matrixLLT().diagonal();
    for (Eigen::Index i = 0; i < diagonal.size(); ++i) deficient += !(diagonal[i] * diagonal[i] > told);
    return factor.solve(MatrixXd::Identity(scaled.rows(), scaled.cols()));
}

}  // namespace

ArrowMatrix::ArrowMatrix(const std::vector<Eigen::Index>& sizes, Eigen::Index corner_size)
    : corner(MatrixXd::Zero(corner_size, corner_size)) {
    for (const Eigen::Index size : sizes) {
        blocks.push_back(MatrixXd::Zero(size, size));
        borders.push_back(MatrixXd::Zero(size, corner_size));
    }
}

ArrowMatrix& ArrowMatrix::add(const ArrowMatrix& other, double factor) {
    for (size_t b = 0; b < blocks.size(); ++b) {
        blocks[b] += factor * other.blocks[b];
        borders[b] += factor * other.borders[b];
    }
    corner += factor * other.corner;
    return *this;
}

double ArrowMatrix::product_trace(const ArrowMatrix& sparse) const {
    double sum = corner.cwiseProduct(sparse.corner).sum();
    for (size_t b = 0; b < blocks.size(); ++b)
        sum += blocks[b].cwiseProduct(sparse.blocks[b]).sum() + 2 * borders[b].cwiseProduct(sparse.borders[b]).sum();
    return sum;
}

ArrowInverse::ArrowInverse(ArrowMatrix matrix, const MatrixXd& held) : matrix_(std::move(matrix)) {
    const auto raise = [](MatrixXd& m) {
        const VectorXd unit = units_of(m);
        m.diagonal().array() += least_curvature / unit.array().square();
        return unit;
    };
    const VectorXd corner_unit = raise(matrix_.corner);
    MatrixXd rest = matrix_.corner;  // what is left of the corner where blocks follow it
    for (size_t b = 0; b < matrix_.blocks.size(); ++b) {
        const VectorXd unit = raise(matrix_.blocks[b]);
        const MatrixXd scaled = unit.asDiagonal() * matrix_.blocks[b] * unit.asDiagonal();
        block_inverses_.push_back(unit.asDiagonal() * inverse_of(scaled, deficient_) * unit.asDiagonal());
        follow_.push_back(-block_inverses_.back() * matrix_.borders[b]);
        rest.noalias() += matrix_.borders[b].transpose() * follow_.back();
    }
    rest = corner_unit.asDiagonal() * rest * corner_unit.asDiagonal();
    // held directions get a curvature of 1 instead of theirs, which is taken out again afterwards
    MatrixXd axes = MatrixXd::Zero(rest.rows(), 0);
    if (held.cols() > 0) {
        const Eigen::ColPivHouseholderQR<MatrixXd> basis(corner_unit.asDiagonal() * held);
        axes = MatrixXd(basis.householderQ()).leftCols(basis.rank());
    }
    const MatrixXd outer = axes * axes.transpose();
    const MatrixXd free = MatrixXd::Identity(rest.rows(), rest.cols()) - outer;
    const MatrixXd fixed = free * rest * free + outer;
    corner_inverse_ = corner_unit.asDiagonal() * (inverse_of(fixed, deficient_) - outer) * corner_unit.asDiagonal();
}

ArrowMatrix ArrowInverse::inverse() const {
    ArrowMatrix out = matrix_;
    out.corner = corner_inverse_;
    for (size_t b = 0; b < follow_.size(); ++b) {
        out.borders[b].noalias() = follow_[b] * corner_inverse_;
        out.blocks[b] = block_inverses_[b];
        out.blocks[b].noalias() += out.borders[b] * follow_[b].transpose();
    }
    return out;
}

// The inverse is D + U C U^T: D the blocks' own inverses, C the corner's, U = (follow, 1).
ArrowMatrix ArrowInverse::around(const ArrowMatrix& m) const {
    std::vector<MatrixXd> pulled;  // m U, block by block
    MatrixXd middle = m.corner;    // U^T m U
    for (size_t b = 0; b < follow_.size(); ++b) {
        pulled.push_back(m.blocks[b] * follow_[b] + m.borders[b]);
        middle.noalias() += follow_[b].transpose() * pulled.back();
        middle.noalias() += m.borders[b].transpose() * follow_[b];
    }
    ArrowMatrix out = m;
    out.corner = corner_inverse_ * middle * corner_inverse_;
    for (size_t b = 0; b < follow_.size(); ++b) {
        const MatrixXd alone = block_inverses_[b] * pulled[b] * corner_inverse_;
        const MatrixXd common = follow_[b] * out.corner;
        out.borders[b] = alone + common;
        MatrixXd& block = out.blocks[b];
        block = block_inverses_[b] * m.blocks[b] * block_inverses_[b];
        block.noalias() += alone * follow_[b].transpose();
        block.noalias() += follow_[b] * alone.transpose();
        block.noalias() += common * follow_[b].transpose();
    }
    return out;
}

}  // namespace radiafit

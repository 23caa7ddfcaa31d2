#include "reference/truncated_svd.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "base/rng.h"

namespace radiafit::fits {
namespace {

// Terms from right singular vectors, the columns of v in descending order; nothing from the first one on whose singular
// value is below 1e-7 of the largest. Gram matrices square the singular values, so what is smaller drowns in rounding:
// far below what photographs of 8 or 16 bits hold.
TruncatedSvd terms_of(const Eigen::MatrixXd& a, const Eigen::MatrixXd& v) {
    TruncatedSvd out{a * v, v};
    const double scale = std::sqrt(double(a.cols())), largest = out.g.col(0).norm();
    bool negligible = false;
    for (Eigen::Index k = 0; k < v.cols(); ++k) {
        negligible = negligible || !(out.g.col(k).norm() > 1e-7 * largest);
        if (negligible) {
            out.g.col(k).setZero();
            out.h.col(k).setZero();
            continue;
        }
        const double sign = v.col(k).sum() < 0 ? -1 : 1;
        out.g.col(k) *= sign / scale;
        out.h.col(k) *= sign * scale;
    }
    return out;
}

Eigen::MatrixXd gram(const Eigen::MatrixXd& rows) {
    Eigen::MatrixXd out = Eigen::MatrixXd::Zero(rows.rows(), rows.rows());
    out.selfadjointView<Eigen::Lower>().rankUpdate(rows);
    return out;
}

Eigen::MatrixXd orthonormal(const Eigen::MatrixXd& narrow) {
    return Eigen::HouseholderQR<Eigen::MatrixXd>(narrow).householderQ() *
           Eigen::MatrixXd::Identity(narrow.rows(), narrow.cols());
}

/// Eigenvectors of a Gram matrix's largest eigenvalues, descending: [size][count]. Only its lower half is read. By
/// orthogonal iteration with some vectors more than asked for, which takes a few products where eigenvalues fall off
/// as those of photographs do; where they don't, by all eigenvectors.
Eigen::MatrixXd first_eigenvectors(const Eigen::MatrixXd& of, Eigen::Index count) {
    constexpr Eigen::Index more = 6, small = 32;
    constexpr int most_rounds = 40;
    const Eigen::Index size = of.rows(), block = count + more;
    Rng rng(1);
    Eigen::MatrixXd v(size, block);
    for (double& x : v.reshaped()) x = double(rng.uniform(-1, 1));
    const auto symmetric = of.selfadjointView<Eigen::Lower>();
    for (int round = 0; size > std::max(small, 2 * block) && round < most_rounds; ++round) {
        v = orthonormal(v);
        Eigen::MatrixXd image = symmetric * v;
        const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> within(v.transpose() * image);  // the best within the span
        const Eigen::MatrixXd turn = within.eigenvectors().rowwise().reverse();
        const Eigen::VectorXd values = within.eigenvalues().reverse();
        v *= turn;
        image *= turn;
        const double off = (image.leftCols(count) - v.leftCols(count) * values.head(count).asDiagonal()).norm();
        if (off <= 1e-13 * values[0]) return v.leftCols(count);
        v = std::move(image);
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(of);
    return eigen.eigenvectors().rowwise().reverse().leftCols(count);
}

/// Orthonormal also where `narrow` lacks rank; descending.
Eigen::MatrixXd left_singular_vectors(const Eigen::MatrixXd& narrow) {
    return Eigen::JacobiSVD<Eigen::MatrixXd>(narrow, Eigen::ComputeThinU).matrixU();
}

}  // namespace

TruncatedSvd truncated_svd(const Eigen::MatrixXd& a, int terms) {
    const Eigen::Index count = std::min<Eigen::Index>({terms, a.rows(), a.cols()});
    Eigen::MatrixXd v = Eigen::MatrixXd::Zero(a.cols(), terms);
    if (a.cols() <= a.rows())
        v.leftCols(count) = first_eigenvectors(gram(a.transpose()), count);
    else
        v.leftCols(count) = left_singular_vectors(a.transpose() * first_eigenvectors(gram(a), count));
    return terms_of(a, v);
}

void refine(const Eigen::MatrixXd& a, TruncatedSvd& svd) {
    const Eigen::Index terms = svd.h.cols(), count = std::min({terms, a.rows(), a.cols()});
    const Eigen::MatrixXd q = orthonormal((a * svd.h).leftCols(count));
    const Eigen::MatrixXd b = a.transpose() * q;  // A's nearest within the span of q is q b^T
    Eigen::MatrixXd v = Eigen::MatrixXd::Zero(a.cols(), terms);
    v.leftCols(count) = left_singular_vectors(b);
    svd = terms_of(a, v);
}

}  // namespace radiafit::fits

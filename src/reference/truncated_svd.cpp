#include "reference/truncated_svd.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace radiafit {

// Eigenvectors of the smaller Gram matrix. It squares the singular values, so what is below 1e-7 of the largest drowns
// in rounding: far below what photographs of 8 or 16 bits hold.
TruncatedSvd truncated_svd(const Eigen::MatrixXd& a, int terms) {
    const Eigen::Index rows = a.rows(), columns = a.cols(), side = std::min(rows, columns);
    const bool by_columns = columns <= rows;
    Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(side, side);
    if (by_columns)
        gram.selfadjointView<Eigen::Lower>().rankUpdate(a.transpose());
    else
        gram.selfadjointView<Eigen::Lower>().rankUpdate(a);
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(gram);  // reads the lower half; ascending

    TruncatedSvd out{Eigen::MatrixXd::Zero(rows, terms), Eigen::MatrixXd::Zero(columns, terms)};
    const double largest = std::sqrt(std::max(0.0, eigen.eigenvalues()[side - 1]));
    const double scale = std::sqrt(double(columns));
    for (Eigen::Index k = 0; k < std::min<Eigen::Index>(terms, side); ++k) {
        const double sigma = std::sqrt(std::max(0.0, eigen.eigenvalues()[side - 1 - k]));
        if (!(sigma > 1e-7 * largest)) break;
        Eigen::VectorXd v = eigen.eigenvectors().col(side - 1 - k);
        if (!by_columns) v = (a.transpose() * v).normalized();
        if (v.sum() < 0) v = -v;
        out.g.col(k) = a * v / scale;
        out.h.col(k) = v * scale;
    }
    return out;
}

}  // namespace radiafit

#pragma once
#include <Eigen/Core>

namespace radiafit {

/// The K largest terms of A = sum_k g_k h_k^T, uncentred: among all sums of that many terms the one nearest to A.
/// h_k has a root mean square of 1 and a sum >= 0; terms beyond A's rank are zero.
struct TruncatedSvd {
    Eigen::MatrixXd g;  ///< [rows][K] sigma_k u_k / sqrt(columns)
    Eigen::MatrixXd h;  ///< [columns][K] v_k sqrt(columns)
};
TruncatedSvd truncated_svd(const Eigen::MatrixXd& a, int terms);

}  // namespace radiafit

#pragma once
#include <Eigen/Core>

#include "base/rings.h"

namespace radiafit::fits {

/// K terms of A ~ sum_k g_k h_k^T, in descending order of their share. h_k has a root mean square of 1 and a sum >= 0;
/// terms beyond A's rank are zero.
struct TruncatedSvd {
    Eigen::MatrixXd g;  ///< [rows][K] sigma_k u_k / sqrt(columns)
    Eigen::MatrixXd h;  ///< [columns][K] v_k sqrt(columns)
};

/// Uncentred: among all sums of K terms the one nearest to A, which must not be empty.
TruncatedSvd truncated_svd(const Eigen::MatrixXd& a, int terms);

/// 1 for an entry that nobody measured, 0 for the others.
using Unmeasured = Eigen::Matrix<uint8_t, Eigen::Dynamic, Eigen::Dynamic>;

/// One step of orthogonal iteration from an earlier factorization, as if A's unmeasured entries, [rows][columns] as A,
/// had their values by it: never farther from the measured entries than it was. What A holds in the others does not
/// matter.
void refine_measured(const Eigen::MatrixXd& a, const Unmeasured& unmeasured, TruncatedSvd& svd);

}  // namespace radiafit::fits

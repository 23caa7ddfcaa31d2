#pragma once
#include <Eigen/Core>

#include "base/linear.h"

/// Decompositions of matrices by Eigen, compiled once: where sources take Eigen's solvers themselves, each
/// compiles them anew, for seconds. All in doubles.
namespace radiafit {

/// Of a symmetric matrix.
struct SymmetricEigen {
    Eigen::VectorXd values;   ///< ascending
    Eigen::MatrixXd vectors;  ///< of unit length, as columns, in the order of `values`
};

/// Only the lower triangle is read.
SymmetricEigen symmetric_eigen(const Eigen::MatrixXd& matrix);

/// Ascending. Only the lower triangle is read.
Eigen::VectorXd symmetric_eigenvalues(const Eigen::MatrixXd& matrix);
Vec3d symmetric_eigenvalues(const Mat3d& matrix);

/// x of matrix x = right, by L D L' with pivots: for symmetric matrices that are definite or nearly so.
Eigen::VectorXd solve_symmetric(const Eigen::MatrixXd& matrix, const Eigen::VectorXd& right);
Eigen::MatrixXd solve_symmetric(const Eigen::MatrixXd& matrix, const Eigen::MatrixXd& right);
Vec3d solve_symmetric(const Mat3d& matrix, const Vec3d& right);

/// By L D L', for the same.
Eigen::MatrixXd inverse_of_symmetric(const Eigen::MatrixXd& matrix);

/// By L L': for symmetric matrices that are positive definite.
Eigen::MatrixXd inverse_of_definite(const Eigen::MatrixXd& matrix);

}  // namespace radiafit

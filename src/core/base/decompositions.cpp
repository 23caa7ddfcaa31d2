#include "base/decompositions.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

namespace radiafit {

using Eigen::MatrixXd, Eigen::VectorXd;
using SymmetricSolver = Eigen::SelfAdjointEigenSolver<MatrixXd>;

SymmetricEigen symmetric_eigen(const MatrixXd& matrix) {
    const SymmetricSolver solver(matrix);
    return {solver.eigenvalues(), solver.eigenvectors()};
}

VectorXd symmetric_eigenvalues(const MatrixXd& matrix) {
    return SymmetricSolver(matrix, Eigen::EigenvaluesOnly).eigenvalues();
}

Vec3d symmetric_eigenvalues(const Mat3d& matrix) {
    return Eigen::SelfAdjointEigenSolver<Mat3d>(matrix, Eigen::EigenvaluesOnly).eigenvalues();
}

VectorXd solve_symmetric(const MatrixXd& matrix, const VectorXd& right) { return matrix.ldlt().solve(right); }

MatrixXd solve_symmetric(const MatrixXd& matrix, const MatrixXd& right) { return matrix.ldlt().solve(right); }

Vec3d solve_symmetric(const Mat3d& matrix, const Vec3d& right) { return matrix.ldlt().solve(right); }

MatrixXd inverse_of_symmetric(const MatrixXd& matrix) {
    return matrix.ldlt().solve(MatrixXd::Identity(matrix.rows(), matrix.cols()));
}

MatrixXd inverse_of_definite(const MatrixXd& matrix) {
    return matrix.llt().solve(MatrixXd::Identity(matrix.rows(), matrix.cols()));
}

}  // namespace radiafit

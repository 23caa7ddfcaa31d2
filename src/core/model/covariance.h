#pragma once
#include <Eigen/Core>
#include <vector>

namespace radiafit {

/// How well the parameters of a least-squares fit are known: variance (J^T J)^-1 at its optimum, in the parameters'
/// units, after Björck, Numerical Methods for Least Squares Problems, 1996, section 1.2.
struct Covariance {
    /// [n][n]. Along directions that the samples don't determine, variances are huge, but finite.
    Eigen::MatrixXd matrix;
    /// [n] standard deviations: square roots of the diagonal; infinite where a direction that the samples don't
    /// determine has a share in the parameter; 0 for a parameter that is held.
    std::vector<double> deviation;
    int deficient = 0;  ///< directions that the samples don't determine
};

/// Directions with less curvature than this count as undetermined; each parameter is in units in which its curvature
/// is 1.
inline constexpr double least_curvature = 1e-9;

/// normal: J^T J, [n][n], of which the lower triangle counts. variance: that of a residual. held: parameters that
/// stay, of which the samples need say nothing.
Covariance covariance_of(const Eigen::MatrixXd& normal, double variance, const std::vector<int>& held = {});

}  // namespace radiafit

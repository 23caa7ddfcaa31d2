#include "model/covariance.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/decompositions.h"

namespace radiafit {
namespace {

std::vector<Eigen::Index> free_parameters(Eigen::Index n, const std::vector<int>& held) {
    std::vector<Eigen::Index> free;
    for (Eigen::Index i = 0; i < n; ++i)
        if (std::ranges::find(held, int(i)) == held.end()) free.push_back(i);
    return free;
}

}  // namespace

Covariance covariance_of(const Eigen::MatrixXd& normal, double variance, const std::vector<int>& held) {
    const Eigen::Index n = normal.rows();
    Covariance out;
    out.matrix = Eigen::MatrixXd::Zero(n, n);
    out.deviation.assign(size_t(n), 0.0);
    const std::vector<Eigen::Index> free = free_parameters(n, held);
    const Eigen::Index count = Eigen::Index(free.size());
    if (count == 0) return out;
    // in units in which each parameter's curvature is 1; a parameter without effect keeps its unit
    Eigen::VectorXd unit(count);
    for (Eigen::Index i = 0; i < count; ++i) {
        const double curvature = normal(free[size_t(i)], free[size_t(i)]);
        unit[i] = curvature > 0 ? 1 / std::sqrt(curvature) : 1;
    }
    Eigen::MatrixXd scaled(count, count);
    for (Eigen::Index i = 0; i < count; ++i)
        for (Eigen::Index j = 0; j <= i; ++j)
            scaled(i, j) =
                unit[i] * unit[j] *
                normal(std::max(free[size_t(i)], free[size_t(j)]), std::min(free[size_t(i)], free[size_t(j)]));
    const SymmetricEigen axes = symmetric_eigen(scaled);
    const Eigen::MatrixXd& direction = axes.vectors;
    const Eigen::VectorXd curvature = axes.values.cwiseMax(least_curvature);
    const Eigen::MatrixXd inverse = direction * curvature.cwiseInverse().asDiagonal() * direction.transpose();
    for (Eigen::Index i = 0; i < count; ++i)
        for (Eigen::Index j = 0; j < count; ++j)
            out.matrix(free[size_t(i)], free[size_t(j)]) = variance * unit[i] * unit[j] * inverse(i, j);
    for (Eigen::Index i = 0; i < count; ++i)
        out.deviation[size_t(free[size_t(i)])] = std::sqrt(out.matrix(free[size_t(i)], free[size_t(i)]));
    constexpr double share = 1e-3;  // of a direction, from which on a parameter takes part in it
    for (Eigen::Index k = 0; k < count; ++k) {
        if (axes.values[k] > least_curvature) continue;
        ++out.deficient;
        for (Eigen::Index i = 0; i < count; ++i)
            if (std::abs(direction(i, k)) > share)
                out.deviation[size_t(free[size_t(i)])] = std::numeric_limits<double>::infinity();
    }
    return out;
}

}  // namespace radiafit

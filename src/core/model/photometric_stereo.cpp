#include "model/photometric_stereo.h"

#include <algorithm>
#include <cmath>

#include "base/decompositions.h"

namespace radiafit {
namespace {

/// Of the mean of l lᵀ: below it, the lamps lie in one plane, or nearly, and noise decides.
constexpr double least_eigenvalue = 1e-3;
constexpr double shadow = 0.1;       // of the upper decile
constexpr double upper_share = 0.1;  // of the lit values, for highlights
constexpr int steps = 10;

/// Indices of what is neither shadow nor highlight, by value.
std::vector<size_t> middle_of(std::span<const float> values) {
    std::vector<size_t> order;
    for (size_t i = 0; i < values.size(); ++i)
        if (std::isfinite(values[i])) order.push_back(i);
    std::sort(order.begin(), order.end(), [&](size_t a, size_t b) { return values[a] < values[b]; });
    if (order.empty()) return order;
    const double bright = values[order[size_t((1 - upper_share) * double(order.size() - 1))]];
    std::erase_if(order, [&](size_t i) { return !(values[i] > 0 && values[i] >= shadow * bright); });
    if (order.size() >= 10) order.resize(order.size() - size_t(upper_share * double(order.size())));
    return order;
}

/// Weighted least squares of values = l · g.
Vec3d solve(std::span<const Vec3d> directions, std::span<const float> values, const std::vector<size_t>& used,
            const std::vector<double>& weights) {
    Mat3d matrix = Mat3d::Zero();
    Vec3d right = Vec3d::Zero();
    for (size_t k = 0; k < used.size(); ++k) {
        const Vec3d& l = directions[used[k]];
        matrix += weights[k] * l * l.transpose();
        right += weights[k] * double(values[used[k]]) * l;
    }
    return solve_symmetric(matrix, right);
}

}  // namespace

bool lamps_give_normals(std::span<const Vec3d> directions) {
    if (directions.size() < 3) return false;
    Mat3d mean = Mat3d::Zero();
    for (const Vec3d& l : directions) mean += l * l.transpose() / double(directions.size());
    return symmetric_eigenvalues(mean)[0] >= least_eigenvalue;
}

Vec3f photometric_normal(std::span<const Vec3d> directions, std::span<const float> values) {
    const std::vector<size_t> used = middle_of(values);
    std::vector<Vec3d> lamps;
    for (const size_t i : used) lamps.push_back(directions[i]);
    if (!lamps_give_normals(lamps)) return Vec3f::Zero();
    std::vector<double> weights(used.size(), 1.0);
    Vec3d g = solve(directions, values, used, weights);
    const double smallest = 1e-3 * double(values[used.back()]);  // an error that counts as none
    for (int step = 0; step < steps; ++step) {
        for (size_t k = 0; k < used.size(); ++k)
            weights[k] = 1 / std::max(std::abs(directions[used[k]].dot(g) - double(values[used[k]])), smallest);
        g = solve(directions, values, used, weights);
    }
    if (!g.allFinite() || !(g.z() > 0)) return Vec3f::Zero();
    return g.normalized().cast<float>();
}

}  // namespace radiafit

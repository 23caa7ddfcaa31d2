#include "geometry/direction_hull.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <functional>

namespace radiafit {
namespace {

/// The point of the cone next to `direction`, by nonnegative least squares (Lawson and Hanson 1974, chapter 23): of
/// three dimensions, never more than three directions carry weight.
Vec3d nearest_in_cone(std::span<const Vec3d> others, const Vec3d& direction) {
    constexpr double tiny = 1e-12;
    std::vector<size_t> used;
    std::vector<double> weight;
    const auto solve = [&] {
        Eigen::Matrix<double, 3, Eigen::Dynamic> a(3, Eigen::Index(used.size()));
        for (size_t i = 0; i < used.size(); ++i) a.col(Eigen::Index(i)) = others[used[i]];
        return Eigen::VectorXd(a.colPivHouseholderQr().solve(direction));
    };
    Vec3d at = Vec3d::Zero();
    for (size_t round = 0; round < 3 * others.size() + 10; ++round) {
        const Vec3d rest = direction - at;
        size_t best = others.size();
        double gain = tiny;
        for (size_t i = 0; i < others.size(); ++i)
            if (const double along = others[i].dot(rest); along > gain) gain = along, best = i;
        if (best == others.size() || std::find(used.begin(), used.end(), best) != used.end()) break;
        used.push_back(best);
        weight.push_back(0);
        for (Eigen::VectorXd wanted = solve(); wanted.size() > 0; wanted = solve()) {
            double step = 1;  // as far towards the solution as no weight becomes negative
            for (size_t i = 0; i < used.size(); ++i)
                if (const double to = wanted[Eigen::Index(i)]; to <= 0)
                    step = std::min(step, weight[i] / (weight[i] - to));
            const bool whole = std::all_of(wanted.begin(), wanted.end(), [](double w) { return w > 0; });
            for (size_t i = 0; i < used.size(); ++i)
                weight[i] = whole ? wanted[Eigen::Index(i)] : weight[i] + step * (wanted[Eigen::Index(i)] - weight[i]);
            if (whole) break;
            for (size_t i = used.size(); i-- > 0;)
                if (weight[i] <= tiny) {
                    used.erase(used.begin() + ptrdiff_t(i));
                    weight.erase(weight.begin() + ptrdiff_t(i));
                }
            if (used.empty()) break;
        }
        at.setZero();
        for (size_t i = 0; i < used.size(); ++i) at += weight[i] * others[used[i]];
    }
    return at;
}

size_t nearest(std::span<const Vec3d> directions, const Vec3d& to) {
    const auto closer = [&](const Vec3d& a, const Vec3d& b) { return a.dot(to) < b.dot(to); };
    return size_t(std::max_element(directions.begin(), directions.end(), closer) - directions.begin());
}

/// Directions far from one another: the next is the one farthest from all chosen before.
std::vector<Vec3d> far_apart(std::span<const Vec3d> directions, size_t count) {
    Vec3d mean = Vec3d::Zero();
    for (const Vec3d& d : directions) mean += d;
    std::vector<Vec3d> chosen = {directions[nearest(directions, mean)]};
    std::vector<double> closest(directions.size(), -2);  // cosine to the nearest chosen one
    while (chosen.size() < count) {
        for (size_t i = 0; i < directions.size(); ++i)
            closest[i] = std::max(closest[i], directions[i].dot(chosen.back()));
        chosen.push_back(directions[size_t(std::min_element(closest.begin(), closest.end()) - closest.begin())]);
    }
    return chosen;
}

}  // namespace

double angle_outside(std::span<const Vec3d> others, const Vec3d& direction) {
    const Vec3d at = nearest_in_cone(others, direction);
    constexpr double rounding = 1e-7;
    const double angle = std::atan2((direction - at).norm(), at.norm());
    return angle < rounding ? 0 : angle;
}

Vec3d nearest_inside(std::span<const Vec3d> others, const Vec3d& direction) {
    if (angle_outside(others, direction) == 0) return direction;
    const Vec3d at = nearest_in_cone(others, direction);
    return at.norm() > 0 ? at.normalized() : others[nearest(others, direction)];
}

std::vector<size_t> spread_over(std::span<const Vec3d> directions, size_t count) {
    std::vector<Vec3d> centres = far_apart(directions, count);
    std::vector<size_t> cluster(directions.size(), 0);
    for (int round = 0; round < 30; ++round) {
        std::vector<Vec3d> sums(count, Vec3d::Zero());
        for (size_t i = 0; i < directions.size(); ++i)
            sums[cluster[i] = nearest(centres, directions[i])] += directions[i];
        for (size_t k = 0; k < count; ++k)
            if (sums[k].norm() > 0) centres[k] = sums[k].normalized();
    }
    // From each cluster the member nearest to its centre; or, where that lies outside the rest's cone, the next one.
    std::vector<std::vector<size_t>> members(count);
    for (size_t i = 0; i < directions.size(); ++i) members[cluster[i]].push_back(i);
    std::erase_if(members, [](const auto& list) { return list.empty(); });
    for (std::vector<size_t>& list : members)
        std::ranges::stable_sort(list, std::greater(),
                                 [&](size_t i) { return directions[i].dot(centres[cluster[i]]); });
    std::vector<size_t> turn(members.size(), 0);
    std::vector<size_t> out(members.size());
    for (bool settled = false; !settled;) {
        for (size_t k = 0; k < members.size(); ++k) out[k] = members[k][turn[k]];
        std::vector<Vec3d> rest;
        for (size_t i = 0; i < directions.size(); ++i)
            if (std::ranges::find(out, i) == out.end()) rest.push_back(directions[i]);
        settled = true;
        for (size_t k = 0; k < members.size() && !rest.empty(); ++k)
            if (turn[k] + 1 < members[k].size() && angle_outside(rest, directions[out[k]]) > 0)
                ++turn[k], settled = false;
    }
    // If a cluster ran empty, because directions occur twice: the first that are left.
    for (size_t i = 0; out.size() < count; ++i)
        if (std::ranges::find(out, i) == out.end()) out.push_back(i);
    std::sort(out.begin(), out.end());
    return out;
}

}  // namespace radiafit

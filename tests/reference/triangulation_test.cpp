// Delaunay triangulation: against the definition, and against the convex hull.
#include "reference/triangulation.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <array>
#include <cmath>
#include <numbers>

#include "base/rng.h"
#include "convex_hull.h"
#include "reference/subset_interpolation.h"

namespace radiafit {
using namespace fits;
namespace {

using testing::cross;
using testing::hull_of;

double distance_to(const Vec2d& a, const Vec2d& b, const Vec2d& p) {
    const double length = (b - a).squaredNorm();
    const double u = length > 0 ? std::clamp((b - a).dot(p - a) / length, 0.0, 1.0) : 0;
    return (a + u * (b - a) - p).norm();
}

std::vector<Vec2d> random_points(int count, Rng& rng) {
    std::vector<Vec2d> points;
    for (int i = 0; i < count; ++i) points.emplace_back(rng.uniform(), rng.uniform());
    return points;
}

std::vector<Vec2d> grid_points(int side) {
    std::vector<Vec2d> points;
    for (int i = 0; i < side * side; ++i) points.emplace_back(0.3 + 0.1 * (i % side), 0.1 * (i / side));
    return points;
}

std::vector<Vec2d> circle_points(int count) {
    std::vector<Vec2d> points;
    for (int i = 0; i < count; ++i) {
        const double angle = 2 * std::numbers::pi * i / count;
        points.emplace_back(0.5 + 0.5 * std::cos(angle), 0.5 + 0.5 * std::sin(angle));
    }
    return points;
}

/// Sets with triangles, regular and degenerate.
std::vector<std::vector<Vec2d>> planar_sets() {
    Rng rng(3);
    std::vector<std::vector<Vec2d>> sets = {grid_points(2), grid_points(7), circle_points(3), circle_points(40)};
    for (int count : {3, 4, 5, 10, 60, 300}) sets.push_back(random_points(count, rng));
    sets.push_back(random_points(30, rng));  // every point three times
    for (int i = 0; i < 60; ++i) sets.back().push_back(sets.back()[size_t(i)]);
    sets.push_back(random_points(20, rng));  // far away, tiny
    for (Vec2d& p : sets.back()) p = Vec2d(100, -7) + 1e-4 * p;
    sets.push_back(random_points(50, rng));  // almost on one line
    for (Vec2d& p : sets.back()) p.y() = 2 * p.x() + 1e-4 * p.y();
    return sets;
}

/// Lower and upper corner of their box.
std::array<Vec2d, 2> bounds(const std::vector<Vec2d>& points) {
    Vec2d low = points[0], high = points[0];
    for (const Vec2d& p : points) low = low.cwiseMin(p), high = high.cwiseMax(p);
    return {low, high};
}

TEST(Triangulation, IsDelaunayAndFillsTheHull) {
    for (const std::vector<Vec2d>& points : planar_sets()) {
        SCOPED_TRACE(points.size());
        const Triangulation triangulation(points);
        const auto [low, high] = bounds(points);
        const double extent = (high - low).maxCoeff();
        double area = 0;
        std::vector<bool> used(points.size());
        for (const auto& t : triangulation.triangles()) {
            const Vec2d &a = points[t[0]], &b = points[t[1]], &c = points[t[2]];
            for (uint32_t i : t) used[i] = true;
            EXPECT_GT(cross(a, b, c), 0);
            area += cross(a, b, c) / 2;
            // a point d is inside the circumcircle where the lifted determinant is positive
            for (const Vec2d& d : points) {
                Eigen::Matrix3d lifted;
                for (int i = 0; i < 3; ++i) {
                    const Vec2d e = (points[t[size_t(i)]] - d) / extent;
                    lifted.row(i) << e.x(), e.y(), e.squaredNorm();
                }
                ASSERT_LT(lifted.determinant(), 1e-12);
            }
        }
        const std::vector<Vec2d> hull = hull_of(points);
        double hull_area = 0, perimeter = 0, border = 0;
        for (size_t i = 0; i < hull.size(); ++i) {
            hull_area += cross(hull[0], hull[i], hull[(i + 1) % hull.size()]) / 2;
            perimeter += (hull[(i + 1) % hull.size()] - hull[i]).norm();
        }
        for (const auto& s : triangulation.border()) border += (points[s[1]] - points[s[0]]).norm();
        EXPECT_NEAR(area, hull_area, 1e-9 * extent * extent);
        EXPECT_NEAR(border, perimeter, 1e-9 * extent);
        for (size_t i = 0; i < points.size(); ++i) {
            const auto twin = size_t(std::find(points.begin(), points.end(), points[i]) - points.begin());
            EXPECT_EQ(used[i], twin == i) << "each place once, by its first point";
        }
    }
}

TEST(Triangulation, ReproducesLinearFunctionsInsideAndTheNearestHullPointOutside) {
    Rng rng(5);
    for (const std::vector<Vec2d>& points : planar_sets()) {
        SCOPED_TRACE(points.size());
        const Triangulation triangulation(points);
        const auto [low, high] = bounds(points);
        const double extent = (high - low).maxCoeff();
        const std::vector<Vec2d> hull = hull_of(points);
        for (int i = 0; i < 300; ++i) {
            const Vec2d place = low - 0.2 * (high - low) +
                                1.4 * (high - low).cwiseProduct(Vec2d(double(rng.uniform()), double(rng.uniform())));
            const Triangulation::Weights w = triangulation.at(place);
            Vec2d at = Vec2d::Zero();
            for (size_t k = 0; k < 3; ++k) {
                EXPECT_GE(w.weight[k], 0);
                at += w.weight[k] * points[w.point[k]];
            }
            EXPECT_NEAR(w.weight[0] + w.weight[1] + w.weight[2], 1, 1e-12);
            double margin = 1e300, nearest = 1e300;  // signed distance inside; distance to the hull's border
            for (size_t k = 0; k < hull.size(); ++k) {
                const Vec2d &a = hull[k], &b = hull[(k + 1) % hull.size()];
                margin = std::min(margin, cross(a, b, place) / (b - a).norm());
                nearest = std::min(nearest, distance_to(a, b, place));
            }
            if (std::abs(margin) < 1e-9 * extent) continue;
            EXPECT_EQ(w.inside, margin > 0);
            EXPECT_NEAR((at - place).norm(), margin > 0 ? 0 : nearest, 1e-9 * extent);
        }
    }
}

TEST(Triangulation, PointsOnOneLineAndFewerThanThree) {
    Rng rng(7);
    std::vector<std::vector<Vec2d>> sets = {{{0.3, 0.4}}, {{0.3, 0.4}, {0.3, 0.4}}, {{0, 0}, {1, 2}}, {{5, 5}, {5, 6}}};
    for (const Vec2d& along : {Vec2d(1, 0), Vec2d(0, 1), Vec2d(0.3, -0.7)}) {
        sets.emplace_back();
        for (int i = 0; i < 12; ++i) sets.back().push_back(Vec2d(0.1, 0.2) + double(rng.index(9)) * along);
    }
    for (const std::vector<Vec2d>& points : sets) {
        const Triangulation triangulation(points);
        EXPECT_TRUE(triangulation.triangles().empty());
        for (int i = 0; i < 50; ++i) {
            const Vec2d place(double(rng.uniform(-3, 8)), double(rng.uniform(-8, 8)));
            const Triangulation::Weights w = triangulation.at(place);
            EXPECT_FALSE(w.inside);
            Vec2d at = Vec2d::Zero();
            for (size_t k = 0; k < 3; ++k) at += w.weight[k] * points[w.point[k]];
            double nearest = 1e300;
            for (const Vec2d& a : points)
                for (const Vec2d& b : points) nearest = std::min(nearest, distance_to(a, b, place));
            EXPECT_NEAR((at - place).norm(), nearest, 1e-9);
        }
    }
    EXPECT_THROW(Triangulation({}), std::invalid_argument);
    const std::vector<Vec2d> bad = {{0, 0}, {1, std::nan("")}};
    EXPECT_THROW(Triangulation{bad}, std::invalid_argument);
}

// Random subsets, from nearly all of the points down to a few, and those that lack a whole side: interpolated values of
// a function that is not linear are those of the subset's own triangulation.
TEST(SubsetInterpolation, IsWhatTheSubsetsOwnTriangulationSays) {
    Rng rng(9);
    std::vector<std::vector<Vec2d>> sets = {{Vec2d(0.3, 0.4)}, {Vec2d(0, 0), Vec2d(1, 1), Vec2d(0.5, 0.5)}};
    for (int count : {4, 10, 60, 200}) sets.push_back(random_points(count, rng));
    sets.push_back(random_points(30, rng));  // some points twice
    for (int i = 0; i < 10; ++i) sets.back().push_back(sets.back()[size_t(i)]);
    std::vector<Vec2d> places;
    for (int i = 0; i < 400; ++i) places.emplace_back(rng.uniform(-0.3, 1.3), rng.uniform(-0.3, 1.3));
    const auto value = [](const Vec2d& p) { return std::sin(9 * p.x()) + p.y() * p.y(); };
    size_t compared = 0;
    for (const std::vector<Vec2d>& points : sets) {
        const SubsetInterpolation interpolation(points, places);
        for (int trial = 0; trial < 60; ++trial) {
            const double share = trial < 20 ? 0.97 : trial < 40 ? 0.8 : 0.3, cut = trial % 4 == 0 ? 0.7 : 2;
            std::vector<uint32_t> subset;
            std::vector<Vec2d> own;
            for (uint32_t i = 0; i < points.size(); ++i)
                if (points[i].x() + 0.2 * points[i].y() < cut && rng.uniform(0, 1) < share) {
                    subset.push_back(i);
                    own.push_back(points[i]);
                }
            if (subset.empty()) continue;
            const Triangulation direct(own);
            const auto weights = interpolation.of(subset);
            ASSERT_EQ(weights.size(), places.size());
            for (size_t k = 0; k < places.size(); ++k) {
                const Triangulation::Weights expected = direct.at(places[k]);
                double a = 0, b = 0;
                for (size_t j = 0; j < 3; ++j) {
                    ASSERT_LT(weights[k].point[j], subset.size());
                    a += weights[k].weight[j] * value(own[weights[k].point[j]]);
                    b += expected.weight[j] * value(own[expected.point[j]]);
                }
                ASSERT_EQ(weights[k].inside, expected.inside) << points.size() << " " << trial << " " << k;
                ASSERT_NEAR(a, b, 1e-9) << points.size() << " " << trial << " " << k;
                ++compared;
            }
        }
    }
    EXPECT_GT(compared, 100000U);
}

}  // namespace
}  // namespace radiafit

// Heights from normals: made reliefs whose heights are known come back, whatever is missing of them.
#include "exchange/normal_integration.h"

#include <gtest/gtest.h>

#include <Eigen/SparseCholesky>
#include <cmath>
#include <functional>

#include "base/error.h"
#include "base/parallel.h"
#include "base/rng.h"

namespace radiafit {
using namespace tools;
namespace {

/// A height and its slopes right and up, at x right and y up.
struct Point {
    double height, right, up;
};
struct MadeRelief {
    int width, height;
    std::array<double, 2> step;
    std::vector<Vec3f> normals;
    std::vector<double> heights;
    std::vector<uint8_t> surface;

    MadeRelief(int w, int h, std::array<double, 2> step_, const std::function<Point(double x, double y)>& shape)
        : width(w), height(h), step(step_) {
        for (int row = 0; row < h; ++row)
            for (int column = 0; column < w; ++column) {
                const Point p = shape((column - 0.5 * (w - 1)) * step[0], (0.5 * (h - 1) - row) * step[1]);
                heights.push_back(p.height);
                normals.push_back(Vec3d(-p.right, -p.up, 1).normalized().cast<float>());
                surface.push_back(std::isfinite(p.height));
                if (!surface.back()) normals.back().setZero();
            }
    }
    size_t at(int column, int row) const { return size_t(row) * size_t(width) + size_t(column); }
    void leave_out(int left, int top, int w, int h) {
        for (int row = top; row < top + h; ++row)
            for (int column = left; column < left + w; ++column) surface[at(column, row)] = 0;
    }
    HeightMap integrated() const { return integrate_normals(width, height, normals, surface, step); }
    double range() const {
        double least = INFINITY, most = -INFINITY;
        for (size_t i = 0; i < heights.size(); ++i)
            if (surface[i]) least = std::min(least, heights[i]), most = std::max(most, heights[i]);
        return most - least;
    }
    /// The largest difference, the means of both over `these` removed.
    double worst(const HeightMap& found, const std::vector<uint8_t>& these) const {
        double mean = 0, count = 0, out = 0;
        for (size_t i = 0; i < heights.size(); ++i)
            if (these[i]) mean += double(found.heights[i]) - heights[i], ++count;
        for (size_t i = 0; i < heights.size(); ++i)
            if (these[i]) out = std::max(out, std::abs(double(found.heights[i]) - heights[i] - mean / count));
        return out;
    }
};

/// A sphere's cap up to 60 degrees, of a radius of 40.
Point cap(double x, double y) {
    constexpr double radius = 40;
    const double square = radius * radius - x * x - y * y, z = std::sqrt(square);
    if (!(square > radius * radius / 4)) return {NAN, 0, 0};
    return {z, -x / z, -y / z};
}
Point waves(double x, double y) {
    return {6 * std::sin(x / 9) * std::cos(y / 7), 6 / 9.0 * std::cos(x / 9) * std::cos(y / 7),
            -6 / 7.0 * std::sin(x / 9) * std::sin(y / 7)};
}

TEST(NormalIntegration, APlaneComesBackWhateverItsTexels) {
    for (const std::array<double, 2> step : {std::array{1.0, 1.0}, {0.02, 0.05}, {300.0, 100.0}}) {
        MadeRelief plane(61, 34, step, [](double x, double y) { return Point{0.3 * x - 0.7 * y, 0.3, -0.7}; });
        plane.leave_out(10, 5, 20, 9);
        const HeightMap found = plane.integrated();
        EXPECT_EQ(found.parts, 1);
        EXPECT_LT(plane.worst(found, plane.surface), 1e-5 * plane.range());  // of floats
        for (size_t i = 0; i < plane.surface.size(); ++i) {
            if (plane.surface[i]) continue;
            ASSERT_EQ(found.heights[i], 0);
        }
    }
}

TEST(NormalIntegration, ACapAndWavesComeBackWithHoles) {
    for (const bool hole : {false, true})
        for (MadeRelief relief : {MadeRelief(81, 81, {1, 1}, cap), MadeRelief(120, 90, {1, 1}, waves)}) {
            if (hole) relief.leave_out(35, 30, 17, 12);
            const HeightMap found = relief.integrated();
            EXPECT_EQ(found.parts, 1);
            EXPECT_LT(relief.worst(found, relief.surface), 0.01 * relief.range()) << (hole ? "with a hole" : "whole");
        }
}

TEST(NormalIntegration, UnknownNormalsAreSpanned) {
    MadeRelief relief(120, 90, {1, 1}, waves);
    std::vector<uint8_t> known = relief.surface;
    Rng rng(3);
    for (size_t i = 0; i < known.size(); ++i)
        if (rng.uniform() < 0.05f) known[i] = 0, relief.normals[i].setZero();
    const HeightMap found = relief.integrated();
    EXPECT_LT(relief.worst(found, known), 0.02 * relief.range());
    EXPECT_LT(relief.worst(found, relief.surface), 0.1 * relief.range());
}

TEST(NormalIntegration, PiecesHaveAMeanOfZeroEach) {
    MadeRelief relief(50, 40, {1, 1}, waves);
    relief.leave_out(24, 0, 2, 40);
    relief.leave_out(0, 0, 2, 40);
    relief.surface[relief.at(0, 7)] = 1;  // a texel by itself
    const HeightMap found = relief.integrated();
    EXPECT_EQ(found.parts, 3);
    EXPECT_EQ(found.heights[relief.at(0, 7)], 0);
    for (const bool left : {true, false}) {
        std::vector<uint8_t> part = relief.surface;
        double sum = 0;
        for (size_t i = 0; i < part.size(); ++i) {
            const int column = int(i) % relief.width;
            part[i] = part[i] && column > 0 && (column < 24) == left;
            if (part[i]) sum += double(found.heights[i]);
        }
        EXPECT_NEAR(sum, 0, 1e-3);
        EXPECT_LT(relief.worst(found, part), 0.01 * relief.range());
    }
}

// Noisy normals agree with no surface: the answer is that of the normal equations, by a direct solver.
TEST(NormalIntegration, NoiseIsSolvedAsTheNormalEquationsAre) {
    MadeRelief relief(37, 29, {1, 0.5}, waves);
    relief.leave_out(12, 8, 9, 7);
    Rng rng(5);
    for (Vec3f& n : relief.normals) {
        n += 0.4f * Vec3f(rng.uniform() - 0.5f, rng.uniform() - 0.5f, rng.uniform() - 0.5f);
        n = Vec3f(n.x(), n.y(), std::max(0.1f, n.z())).normalized();
    }
    const auto n = Eigen::Index(relief.normals.size());
    std::vector<Eigen::Triplet<double>> entries;
    Eigen::VectorXd b = Eigen::VectorXd::Zero(n);
    const auto join = [&](size_t i, size_t k, double step, int axis) {
        if (!relief.surface[i] || !relief.surface[k]) return;
        const Vec3d one = relief.normals[i].cast<double>(), other = relief.normals[k].cast<double>();
        const double weight = one.z() * other.z(), sign = axis == 0 ? -1 : 1;
        const double rise = sign * step * (one[axis] / one.z() + other[axis] / other.z()) / 2;
        const auto p = Eigen::Index(i), q = Eigen::Index(k);
        for (const auto& [row, column, value] :
             {std::tuple{p, p, weight}, {q, q, weight}, {p, q, -weight}, {q, p, -weight}})
            entries.emplace_back(int(row), int(column), value);
        b[p] -= weight * rise;
        b[q] += weight * rise;
    };
    for (int row = 0; row < relief.height; ++row)
        for (int column = 0; column < relief.width; ++column) {
            if (column + 1 < relief.width) join(relief.at(column, row), relief.at(column + 1, row), 1, 0);
            if (row + 1 < relief.height) join(relief.at(column, row), relief.at(column, row + 1), 0.5, 1);
        }
    for (Eigen::Index i = 0; i < n; ++i) entries.emplace_back(int(i), int(i), relief.surface[size_t(i)] ? 1e-10 : 1);
    Eigen::SparseMatrix<double> matrix(n, n);
    matrix.setFromTriplets(entries.begin(), entries.end());
    const Eigen::VectorXd expected = Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>(matrix).solve(b);
    relief.heights.assign(expected.begin(), expected.end());
    EXPECT_LT(relief.worst(relief.integrated(), relief.surface), 1e-5 * relief.range());
}

TEST(NormalIntegration, ThreadsChangeNothingAndBadInputIsRefused) {
    const MadeRelief relief(330, 210, {1, 1}, waves);
    set_thread_count(1);
    const std::vector<float> alone = relief.integrated().heights;
    set_thread_count(3);
    EXPECT_EQ(relief.integrated().heights, alone);
    set_thread_count(0);
    const auto refused = [&](int w, int h, std::vector<Vec3f> normals, std::array<double, 2> step) {
        EXPECT_THROW(integrate_normals(w, h, normals, {}, step), UserError);
    };
    refused(330, 220, relief.normals, {1, 1});
    refused(0, 0, {}, {1, 1});
    refused(330, 210, relief.normals, {1, 0});
    refused(330, 210, relief.normals, {NAN, 1});
    std::vector<Vec3f> bad = relief.normals;
    bad[40].x() = NAN;
    refused(330, 210, bad, {1, 1});
    EXPECT_EQ(integrate_normals(1, 1, std::vector<Vec3f>(1, Vec3f::UnitZ()), {}, {1, 1}).heights[0], 0);
}

}  // namespace
}  // namespace radiafit

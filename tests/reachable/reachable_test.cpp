// What is reachable: Gaussian processes over view directions, and blended photographs.
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>

#include "base/rng.h"
#include "reachable/direction_process.h"

namespace radiafit::testing {
using namespace fits;
namespace {

Vec3f drawn_direction(Rng& rng) {
    return Vec3f(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(0.3f, 1)).normalized();
}

double normal(Rng& rng) {  // Box and Muller
    const double u = 1 - double(rng.uniform(0, 1)), v = double(rng.uniform(0, 1));
    return std::sqrt(-2 * std::log(std::max(u, 1e-12))) * std::cos(6.283185307179586 * v);
}

double covariance(const DirectionProcess& p, const Vec3f& a, const Vec3f& b) {
    const double r = std::sqrt(5.0) * double((a - b).norm()) / p.length;
    return p.level + p.amplitude * (1 + r + r * r / 3) * std::exp(-r);
}

/// Colours that the process gives a place.
SeenColours drawn(const DirectionProcess& p, int n, Rng& rng) {
    SeenColours out;
    Eigen::MatrixXd k(n, n);
    for (int i = 0; i < n; ++i) {
        out.directions.push_back(drawn_direction(rng));
        out.weights.push_back(rng.uniform(0.3f, 1));
    }
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j)
            k(i, j) = covariance(p, out.directions[size_t(i)], out.directions[size_t(j)]) +
                      (i == j ? p.noise / double(out.weights[size_t(i)]) : 0);
    const Eigen::MatrixXd root = k.llt().matrixL();
    out.colours.resize(size_t(n));
    for (int c = 0; c < 3; ++c) {
        Eigen::VectorXd z(n);
        for (double& x : z) x = normal(rng);
        const Eigen::VectorXd values = root * z;
        for (int i = 0; i < n; ++i) out.colours[size_t(i)][c] = float(p.mean[c] + values[i]);
    }
    return out;
}

DirectionProcess known_process() {
    DirectionProcess p;
    p.mean = {0.4, 0.5, 0.3};
    p.level = 0.03;
    p.amplitude = 0.02;
    p.length = 0.6;
    p.noise = 5e-4;
    return p;
}

TEST(DirectionProcess, EvidenceHasTheGradientOfDifferences) {
    Rng rng(1);
    const SeenColours seen = drawn(known_process(), 15, rng);
    DirectionProcess at = known_process();
    at.length = 0.4;
    at.level = 0.05;
    const Evidence here = evidence(at, seen);
    constexpr double step = 1e-4;
    double DirectionProcess::*const members[] = {&DirectionProcess::level, &DirectionProcess::amplitude,
                                                 &DirectionProcess::length, &DirectionProcess::noise};
    for (int k = 0; k < Evidence::parameters; ++k) {
        DirectionProcess above = at, below = at;
        above.*members[k] *= std::exp(step);
        below.*members[k] *= std::exp(-step);
        const double slope = (evidence(above, seen).log - evidence(below, seen).log) / (2 * step);
        EXPECT_NEAR(here.gradient[k], slope, 1e-4 * (1 + std::abs(slope))) << k;
    }
    for (int c = 0; c < 3; ++c) {
        DirectionProcess above = at, below = at;
        above.mean[c] += step;
        below.mean[c] -= step;
        const double slope = (evidence(above, seen).log - evidence(below, seen).log) / (2 * step);
        EXPECT_NEAR(here.mean_gradient[c], slope, 1e-4 * (1 + std::abs(slope))) << c;
    }
}

TEST(DirectionProcess, LearningFindsTheOneThatColoursAreDrawnFrom) {
    Rng rng(2);
    const DirectionProcess truth = known_process();
    std::vector<SeenColours> places;
    for (int i = 0; i < 300; ++i) places.push_back(drawn(truth, 12, rng));
    const DirectionProcess found = most_likely_process(places, DirectionProcess());
    EXPECT_NEAR(found.level / truth.level, 1, 0.25);
    EXPECT_NEAR(found.amplitude / truth.amplitude, 1, 0.15);
    EXPECT_NEAR(found.length / truth.length, 1, 0.15);
    EXPECT_NEAR(found.noise / truth.noise, 1, 0.15);
    EXPECT_LT((found.mean - truth.mean).norm(), 0.05);
}

TEST(DirectionProcess, WithoutNoiseTheMeanPassesThroughTheSamples) {
    Rng rng(3);
    DirectionProcess p = known_process();
    const SeenColours seen = drawn(p, 8, rng);
    p.noise = 1e-9;
    const auto weights = posterior_weights(p, seen);
    for (size_t j = 0; j < seen.size(); ++j) {
        Vec3d sum = p.mean;
        for (size_t i = 0; i < seen.size(); ++i)
            sum += covariance(p, seen.directions[i], seen.directions[j]) * weights.row(Eigen::Index(i)).transpose();
        EXPECT_LT((sum - seen.colours[j].cast<double>()).norm(), 1e-4);
    }
}

}  // namespace
}  // namespace radiafit::testing

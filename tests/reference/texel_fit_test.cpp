// Batched fits of texel-local models: sums, known answers, Ceres on the same texels, and every odd set of samples.
#include <gtest/gtest.h>

#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <limits>

#include "base/rng.h"
#include "cpu/texel_fit_impl.h"
#include "cpu/texel_models.h"
#include "cpu/texel_solver.h"
#include "reference/ceres_texel.h"
#include "texel_scene.h"

namespace radiafit {
using namespace fits;

/// A polynomial texture map (Malzbender et al. 2001): linear, no shape.
template <class real_type>
struct PolynomialText {
    using real = real_type;
    static constexpr int term_count = 2, basis_count = 6, shape_count = 0;
    struct Terms {
        real x[2];
    };
    struct Shape {
        real x[1];
    };
    struct Basis {
        real x[6];
    };
    static Basis basis(Shape, Terms t) {
        return {{t.x[0] * t.x[0], t.x[1] * t.x[1], t.x[0] * t.x[1], t.x[0], t.x[1], real(1.0)}};
    }
    using real3 = shared_text::real3_t<real>;
    static Terms sample_terms(real3 u, real3) { return {{u.x, u.y}}; }
    static constexpr const char* coefficient_names[6] = {"xx", "yy", "xy", "x", "y", "one"};
    static constexpr double coefficient_bounds[6][2] = {{-1e30, 1e30}, {-1e30, 1e30}, {-1e30, 1e30},
                                                        {-1e30, 1e30}, {-1e30, 1e30}, {-1e30, 1e30}};
};

namespace {

using namespace testing;
using Text = LafortuneText<double>;
using Fit = TexelFit<LafortuneText<Pack>>;
using Parameters = LafortuneModel::Parameters;

Parameters doubles(const Fit::Parameters& p) {
    Parameters out;
    std::copy(p.begin(), p.end(), out.begin());
    return out;
}
double squared_error(const Parameters& p, const LafortuneTexel& texel) {
    double sum = 0;
    for (const LafortuneSample& s : texel) {
        const auto value = LafortuneModel::value(p, {{double(s.term[0]), double(s.term[1]), double(s.term[2])}});
        for (size_t c = 0; c < 3; ++c) sum += 0.5 * double(s.weight) * std::pow(value[c] - double(s.target[c]), 2);
    }
    return sum;
}
double rmse(double error, size_t samples) { return std::sqrt(2 * error / double(3 * samples)); }
/// The worst of nine relative errors, n itself and not its logarithm.
double worst(Parameters p, Parameters truth) {
    p[8] = std::exp(p[8]), truth[8] = std::exp(truth[8]);
    double out = 0;
    for (size_t i = 0; i < p.size(); ++i) out = std::max(out, std::abs(p[i] - truth[i]) / std::abs(truth[i]));
    return out;
}
bool usable(const Fit::Outcome& o) {
    for (int i = 0; i < LafortuneModel::parameters; ++i) {
        const double x = double(o.parameters[size_t(i)]), slack = 1e-6;
        if (!std::isfinite(x) || x < LafortuneModel::bounds(i)[0] - slack || x > LafortuneModel::bounds(i)[1] + slack)
            return false;
    }
    return std::isfinite(o.error) && o.error >= 0 && std::abs(std::max(-o.parameters[6], o.parameters[7]) - 1) < 1e-6f;
}

struct TexelFitScene {
    std::vector<Parameters> truth;
    std::vector<LafortuneTexel> texels;
    TexelFitScene(size_t count, double n_low, double n_high, double noise, uint64_t seed, size_t samples = 230) {
        Rng rng(seed);
        for (size_t i = 0; i < count; ++i) {
            truth.push_back(random_lobe(rng, n_low, n_high));
            texels.push_back(sample_texel(rng, truth.back(), samples, noise));
        }
    }
    std::vector<Fit::Outcome> fit(const Fit& fit = Fit()) const {
        std::vector<Fit::Outcome> out;
        Fit::Batch batch;
        for (size_t i = 0; i < texels.size(); i += 8) {
            batch.clear();
            for (size_t lane = 0; lane < 8 && i + lane < texels.size(); ++lane)
                for (const LafortuneSample& s : texels[i + lane]) batch.push(int(lane), s);
            const auto outcomes = fit.solve(batch);
            for (size_t lane = 0; lane < 8 && i + lane < texels.size(); ++lane) out.push_back(outcomes[lane]);
        }
        return out;
    }
};
// Lobes that a few hundred random pairs of directions sample well, and lobes that a few of them meet.
constexpr double moderate[] = {3, 30}, sharp[] = {30, 150};

// Floats against double on the same text: within 1e-5 of the sum of the terms' magnitudes; a lobe multiplies the
// rounding of D by n.
TEST(TexelSums, AreThoseOfTheirDefinitions) {
    Rng rng(1);
    for (const double n : {1.0, 10.0, 60.0, 200.0})
        for (const size_t samples : {size_t(1), size_t(63), size_t(64), size_t(65), size_t(500)}) {
            Fit::Batch batch;
            TexelLocal<LafortuneText<Pack>>::Parameters packed;
            std::vector<Parameters> p;
            std::vector<LafortuneTexel> texels;
            for (int lane = 0; lane < 8; ++lane) {
                p.push_back(random_lobe(rng, n, n));
                texels.push_back(sample_texel(rng, random_lobe(rng, 3, 30), samples, 0.01, 1e-3));
                for (LafortuneSample& s : texels.back()) s.weight = rng.uniform(0.1f, 2), batch.push(lane, s);
                for (size_t i = 0; i < 9; ++i) {
                    packed[i].set(lane, float(p.back()[i]));
                    p.back()[i] = double(float(p.back()[i]));
                }
            }
            const auto sums = texel_sums<LafortuneText<Pack>>(batch.rows(), packed);
            for (int lane = 0; lane < 8; ++lane) {
                double shared[5][5] = {}, linear[5][3] = {}, error = 0, shared_size[5][5] = {}, linear_size[5][3] = {};
                for (const LafortuneSample& s : texels[size_t(lane)]) {
                    const Text::Terms t{{double(s.term[0]), double(s.term[1]), double(s.term[2])}};
                    const auto q = LafortuneModel::columns(LafortuneModel::shape_of(p[size_t(lane)]), t);
                    const auto value = LafortuneModel::value(p[size_t(lane)], t);
                    const double w = double(s.weight);
                    for (size_t i = 0; i < 5; ++i) {
                        for (size_t j = 0; j < 5; ++j) {
                            shared[i][j] += w * q[i] * q[j];
                            shared_size[i][j] += std::abs(w * q[i] * q[j]);
                        }
                        for (size_t c = 0; c < 3; ++c) {
                            linear[i][c] += w * q[i] * (value[c] - double(s.target[c]));
                            linear_size[i][c] += std::abs(w * q[i]) * (value[c] + double(std::abs(s.target[c])));
                        }
                    }
                    for (size_t c = 0; c < 3; ++c) error += 0.5 * w * std::pow(value[c] - double(s.target[c]), 2);
                }
                const double tolerance = 1e-5 * std::max(1.0, n / 30);
                for (size_t i = 0; i < 5; ++i) {
                    for (size_t j = 0; j <= i; ++j)
                        ASSERT_NEAR(sums.shared[i][j][lane], shared[i][j], tolerance * shared_size[i][j] + 1e-30) << n;
                    for (size_t c = 0; c < 3; ++c)
                        ASSERT_NEAR(sums.linear[i][c][lane], linear[i][c], tolerance * linear_size[i][c] + 1e-30) << n;
                }
                ASSERT_NEAR(sums.error[lane], error, tolerance * (error + 1e-3));
            }
        }
}

/// Lafortune's lobe with other starts: `count` of them, of which runs of five differ in their last value only.
template <size_t count>
struct OtherStarts : LafortuneText<Pack> {
    static constexpr int start_count = int(count);
    static constexpr auto starts = [] {
        std::array<std::array<double, 3>, count> out{};
        for (size_t i = 0; i < count; ++i) out[i] = {-1 + 0.1 * double(i / 5), 1, 1 + 0.5 * double(i % 5)};
        return out;
    }();
    static void last_basis_at_starts() = delete;  // those of Lafortune's own starts
};

template <class Other>
void expect_sums_of_each_start(size_t group) {
    EXPECT_EQ(start_group<Other>(), group);
    Rng rng(4);
    const LafortuneTexel texel = sample_texel(rng, random_lobe(rng, 3, 30), 100, 0.01);
    Fit::Batch batch;
    for (const LafortuneSample& s : texel) batch.push(2, s);
    const auto sums = start_sums<Other>(batch.rows());
    for (size_t i = 0; i < size_t(Other::start_count); ++i) {
        double lobe[2] = {}, target[3] = {};
        for (const LafortuneSample& s : texel) {
            const auto b = Text::basis({{Other::starts[i][0], Other::starts[i][1], Other::starts[i][2]}},
                                       {{double(s.term[0]), double(s.term[1]), double(s.term[2])}});
            for (size_t k = 0; k < 2; ++k) lobe[k] += double(s.weight) * b.x[k] * b.x[1];
            for (size_t c = 0; c < 3; ++c) target[c] += double(s.weight) * b.x[1] * double(s.target[c]);
        }
        for (size_t k = 0; k < 2; ++k) EXPECT_NEAR(sums.lobe[i][0][k][2], lobe[k], 1e-5 * lobe[k]) << "start " << i;
        for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(sums.lobe_target[i][0][c][2], target[c], 1e-5 * target[c]);
    }
}

TEST(TexelFit, AnyNumberOfStartsIsSummed) {
    expect_sums_of_each_start<LafortuneText<Pack>>(5);
    expect_sums_of_each_start<OtherStarts<1>>(1);
    expect_sums_of_each_start<OtherStarts<4>>(4);
    expect_sums_of_each_start<OtherStarts<6>>(1);
    expect_sums_of_each_start<OtherStarts<7>>(1);
    expect_sums_of_each_start<OtherStarts<10>>(5);
}

TEST(TexelFit, StartsWhereTheBestOfAllStartsIs) {
    const TexelFitScene scene(64, 3, 150, 0.01, 2);
    for (size_t i = 0; i < scene.texels.size(); ++i) {
        Fit::Batch batch;
        for (const LafortuneSample& s : scene.texels[i]) batch.push(3, s);
        const double error = squared_error(doubles(Fit::start(batch)[3]), scene.texels[i]);
        double lowest = std::numeric_limits<double>::infinity();
        for (const auto& shape : Text::starts) {  // coefficients by dense least squares, where those are within bounds
            Eigen::MatrixXd columns(long(scene.texels[i].size()), 2), targets(long(scene.texels[i].size()), 3);
            for (size_t k = 0; k < scene.texels[i].size(); ++k) {
                const LafortuneSample& s = scene.texels[i][k];
                const auto b = Text::basis({{shape[0], shape[1], shape[2]}},
                                           {{double(s.term[0]), double(s.term[1]), double(s.term[2])}});
                columns.row(long(k)) << b.x[0], b.x[1];
                targets.row(long(k)) << s.target[0], s.target[1], s.target[2];
            }
            const Eigen::MatrixXd a = columns.householderQr().solve(targets);
            const bool within = a.minCoeff() >= 0 && a.row(0).maxCoeff() <= 1 && a.row(1).maxCoeff() <= 4;
            if (within) lowest = std::min(lowest, 0.5 * (columns * a - targets).squaredNorm());
        }
        EXPECT_LE(error, lowest * (1 + 1e-5)) << i;
    }
}

TEST(TexelFit, RecoversWhatNoiseFreeSamplesWereMadeOf) {
    for (const auto& range : {moderate, sharp}) {
        const TexelFitScene scene(320, range[0], range[1], 0, 3);
        const auto outcomes = scene.fit();
        std::vector<double> errors;
        for (size_t i = 0; i < outcomes.size(); ++i) {
            ASSERT_TRUE(usable(outcomes[i])) << i;
            errors.push_back(worst(doubles(outcomes[i].parameters), scene.truth[i]));
        }
        std::sort(errors.begin(), errors.end());
        EXPECT_LT(errors[errors.size() / 2], 1e-3) << "median texel, worst of nine; n from " << range[0];
        EXPECT_LT(errors[errors.size() * 9 / 10], 1e-2) << "n from " << range[0];
    }
}

void expect_as_good_as_ceres(const double (&range)[2], double noise, uint64_t seed, double share) {
    const TexelFitScene scene(320, range[0], range[1], noise, seed);
    const auto outcomes = scene.fit();
    int good = 0, converged = 0;
    for (size_t i = 0; i < outcomes.size(); ++i) {
        ASSERT_TRUE(usable(outcomes[i])) << i;
        Fit::Batch batch;
        for (const LafortuneSample& s : scene.texels[i]) batch.push(0, s);
        const auto ceres = ceres_texels<Text>({})->solve(scene.texels[i], doubles(Fit::start(batch)[0]));
        // rounding of parameters to floats is all that a noise-free fit leaves
        good += rmse(outcomes[i].error, 230) <= 1.05 * rmse(ceres.error, 230) + 2e-6 ? 1 : 0;
        converged += ceres.status == Status::stationary ? 1 : 0;
    }
    EXPECT_GE(good, share * double(outcomes.size()));
    EXPECT_GE(converged, 0.95 * double(outcomes.size())) << "a reference that fails proves nothing";
}
TEST(TexelFit, IsAsGoodAsCeresOnModerateLobes) { expect_as_good_as_ceres(moderate, 0.005, 4, 0.99); }
TEST(TexelFit, IsAsGoodAsCeresOnSharpLobes) { expect_as_good_as_ceres(sharp, 0.005, 5, 0.97); }
TEST(TexelFit, IsAsGoodAsCeresWithoutNoise) { expect_as_good_as_ceres(moderate, 0, 6, 0.99); }

TEST(TexelFit, TellsItsErrorAndNoSmallStepLowersIt) {
    const TexelFitScene scene(64, 3, 60, 0.01, 7);
    const auto outcomes = scene.fit();
    Rng rng(7);
    for (size_t i = 0; i < outcomes.size(); ++i) {
        const Parameters p = doubles(outcomes[i].parameters);
        const double error = squared_error(p, scene.texels[i]);
        EXPECT_NEAR(outcomes[i].error, error, 1e-5 * error);
        EXPECT_EQ(outcomes[i].status, Status::stationary) << i;
        EXPECT_EQ(outcomes[i].samples, 230u);
        for (int trial = 0; trial < 100; ++trial) {
            Parameters q = p;
            for (size_t k = 0; k < q.size(); ++k) q[k] += 1e-3 * double(rng.uniform(-1, 1));
            EXPECT_GT(squared_error(q, scene.texels[i]), error * (1 - 1e-5)) << i;
        }
    }
}

TEST(TexelFit, ATexelsResultIsItsOwn) {
    const TexelFitScene scene(24, 3, 150, 0.01, 8, 100);
    Rng rng(8);
    std::vector<Fit::Outcome> alone;
    for (const LafortuneTexel& texel : scene.texels) {
        Fit::Batch batch;
        for (const LafortuneSample& s : texel) batch.push(0, s);
        alone.push_back(Fit().solve(batch)[0]);
    }
    for (int trial = 0; trial < 30; ++trial) {
        // other lanes: other texels, more or fewer samples, none, and broken ones
        Fit::Batch batch;
        size_t at[8];
        for (int lane = 0; lane < 8; ++lane) {
            at[lane] = rng.index(24);
            if (lane == 3) continue;
            if (lane == 5) batch.push(lane, {{0, 0, std::numeric_limits<float>::quiet_NaN()}, {1, 1, 1}, 1});
            for (int copy = 0; copy < (lane == 6 ? 3 : 1); ++copy)
                for (const LafortuneSample& s : scene.texels[at[lane]]) batch.push(lane, s);
        }
        const auto outcomes = Fit().solve(batch);
        for (int lane : {0, 1, 2, 4, 7}) {
            const Fit::Outcome &mine = outcomes[size_t(lane)], &expected = alone[at[lane]];
            EXPECT_EQ(mine.parameters, expected.parameters);
            EXPECT_EQ(mine.error, expected.error);
            EXPECT_EQ(mine.iterations, expected.iterations);
            EXPECT_EQ(mine.status, expected.status);
        }
        EXPECT_EQ(outcomes[3].status, Status::no_samples);
        EXPECT_EQ(outcomes[5].status, Status::not_finite);
        for (const auto& o : outcomes) EXPECT_TRUE(usable(o));
    }
}

TEST(TexelFit, WeightsCountAsSamplesDo) {
    const TexelFitScene scene(8, 3, 30, 0.01, 9);
    Fit::Batch weighted, repeated, gaps;
    Rng rng(9);
    for (int lane = 0; lane < 8; ++lane)
        for (const LafortuneSample& s : scene.texels[size_t(lane)]) {
            LafortuneSample heavy = s, none = s;
            heavy.weight = float(1 + rng.index(3));
            weighted.push(lane, heavy);
            for (int i = 0; i < int(heavy.weight); ++i) repeated.push(lane, s);
            none.weight = 0;
            none.target = {9, 9, 9};
            if (rng.uniform() < 0.5f) gaps.push(lane, none);
            gaps.push(lane, heavy);
            gaps.push(lane, none);
        }
    const auto a = Fit().solve(weighted), b = Fit().solve(repeated), c = Fit().solve(gaps);
    for (size_t lane = 0; lane < 8; ++lane) {
        EXPECT_NEAR(a[lane].error, b[lane].error, 1e-5 * b[lane].error);
        EXPECT_LT(worst(doubles(a[lane].parameters), doubles(b[lane].parameters)), 1e-2);
        EXPECT_GT(b[lane].samples, a[lane].samples);
        EXPECT_EQ(c[lane].parameters, a[lane].parameters) << "no weight, no effect";
        EXPECT_EQ(c[lane].samples, a[lane].samples);
    }
}

TEST(TexelFit, FewSamplesGiveAStatusAndFiniteNumbers) {
    Rng rng(10);
    for (size_t count = 0; count < 8; ++count)
        for (int trial = 0; trial < 20; ++trial) {
            Fit::Batch batch;
            for (int lane = 0; lane < 8; ++lane)
                for (const LafortuneSample& s : sample_texel(rng, random_lobe(rng, 3, 150), count, 0.01))
                    batch.push(lane, s);
            for (const auto& o : Fit().solve(batch)) {
                EXPECT_TRUE(usable(o)) << count << " samples: " << ::testing::PrintToString(o.parameters);
                EXPECT_EQ(o.samples, count);
                EXPECT_EQ(o.status == Status::no_samples, count == 0);
                if (count > 0 && count < 4) {  // the Jacobian has four columns that differ
                    EXPECT_EQ(o.status, Status::underdetermined) << count;
                }
            }
        }
    // many samples, all the same, or all without weight
    Fit::Batch batch;
    const LafortuneTexel texel = sample_texel(rng, random_lobe(rng, 3, 30), 1);
    for (int i = 0; i < 100; ++i) {
        LafortuneSample s = texel[0];
        batch.push(0, s);
        s.weight = 0;
        batch.push(1, s);
    }
    const auto outcomes = Fit().solve(batch);
    EXPECT_EQ(outcomes[0].status, Status::underdetermined);
    EXPECT_LT(outcomes[0].error, 1e-8) << "yet it fits";
    EXPECT_EQ(outcomes[1].status, Status::no_samples);
}

TEST(TexelFit, ExtremeTexelsStayWithinBounds) {
    Rng rng(11);
    for (int trial = 0; trial < 50; ++trial) {
        Fit::Batch batch;
        for (int lane = 0; lane < 8; ++lane) {
            Parameters p = random_lobe(rng, 1, 400);  // beyond the bound of 200
            if (lane == 0) p[3] = p[4] = p[5] = 0;    // no lobe
            if (lane == 1) p[0] = p[1] = p[2] = 0;    // nothing else
            if (lane == 2) p[0] = 5, p[4] = 40;       // beyond bounds
            if (lane == 3) p[6] = 0;                  // lobe of the normal
            if (lane == 4) p[6] = -1, p[7] = 0;       // of grazing light only
            if (lane == 5)
                for (size_t k = 0; k < 6; ++k) p[k] = 0;  // black
            if (lane == 6)
                for (size_t k = 0; k < 6; ++k) p[k] *= -1;  // below it
            for (const LafortuneSample& s : sample_texel(rng, p, 100, lane == 5 ? 0 : 0.02, 1e-4)) batch.push(lane, s);
        }
        const auto outcomes = Fit().solve(batch);
        for (const auto& o : outcomes) EXPECT_TRUE(usable(o));
        for (size_t k = 0; k < 6; ++k) EXPECT_NEAR(outcomes[5].parameters[k], 0, 1e-6) << "black stays black";
        EXPECT_EQ(outcomes[2].parameters[0], 1);
        for (size_t k = 0; k < 3; ++k) EXPECT_LT(outcomes[6].parameters[k], 0.1f);
    }
}

TEST(TexelFit, GoesOnFromGivenParameters) {
    const TexelFitScene scene(8, 3, 30, 0.01, 12);
    Fit::Batch batch;
    for (int lane = 0; lane < 8; ++lane)
        for (const LafortuneSample& s : scene.texels[size_t(lane)]) batch.push(lane, s);
    const auto outcomes = Fit().solve(batch);
    std::array<Fit::Parameters, 8> start;
    for (size_t lane = 0; lane < 8; ++lane) start[lane] = outcomes[lane].parameters;
    for (const auto& o : Fit().solve(batch, start)) EXPECT_LE(o.iterations, 1) << "it is there";
    const auto started = Fit(TexelFitOptions{.iterations = 0}).solve(batch);
    for (size_t lane = 0; lane < 8; ++lane) {
        EXPECT_EQ(started[lane].status, Status::max_iterations);
        EXPECT_EQ(started[lane].iterations, 0);
        EXPECT_GE(started[lane].error, outcomes[lane].error);
    }
    for (auto& p : start) p = {9, 9, 9, 9, 9, 9, -9, 9, 99};
    for (const auto& o : Fit().solve(batch, start)) EXPECT_TRUE(usable(o)) << "put within bounds";
}

TEST(TexelFit, AModelWithoutAShapeIsOneLinearSolve) {
    using Polynomial = TexelFit<PolynomialText<Pack>>;
    Rng rng(13);
    Polynomial::Batch batch;
    std::vector<Eigen::MatrixXd> columns, targets;
    for (int lane = 0; lane < 8; ++lane) {
        const long count = lane == 7 ? 4 : 50 + 10 * lane;
        columns.emplace_back(count, 6);
        targets.emplace_back(count, 3);
        for (long i = 0; i < count; ++i) {
            const float x = rng.uniform(-0.8f, 0.8f), y = rng.uniform(-0.8f, 0.8f);
            TexelSample<2> s{{x, y}, {rng.uniform(), x + rng.uniform(), -y * y}, 1};
            batch.push(lane, s);
            const double u = double(x), v = double(y);
            columns.back().row(i) << u * u, v * v, u * v, u, v, 1;
            targets.back().row(i) << double(s.target[0]), double(s.target[1]), double(s.target[2]);
        }
    }
    const auto outcomes = Polynomial().solve(batch);
    for (size_t lane = 0; lane < 7; ++lane) {
        const Eigen::MatrixXd expected = columns[lane].householderQr().solve(targets[lane]);
        for (size_t k = 0; k < 6; ++k)
            for (size_t c = 0; c < 3; ++c)
                EXPECT_NEAR(double(outcomes[lane].parameters[3 * k + c]), expected(long(k), long(c)), 1e-5) << lane;
        const double error = 0.5 * (columns[lane] * expected - targets[lane]).squaredNorm();
        EXPECT_NEAR(outcomes[lane].error, error, 1e-5 * error);
        EXPECT_EQ(outcomes[lane].status, Status::stationary);
    }
    EXPECT_EQ(outcomes[7].status, Status::underdetermined);
    for (const float x : outcomes[7].parameters) EXPECT_TRUE(std::isfinite(x));
    EXPECT_LT(outcomes[7].error, 1e-4) << "four samples, six unknowns: it goes through them";
}

// Conditions of Karush, Kuhn and Tucker, and never worse than staying.
TEST(BoundedStep, IsTheOptimumWithinBounds) {
    constexpr double bounds[2][2] = {{0, 1}, {0, 4}};
    Rng rng(14);
    int at_bound = 0;
    for (int trial = 0; trial < 20000; ++trial) {
        SmallMatrix<double, 2> a{};
        for (int i = 0; i < 4; ++i) {
            const double x = double(rng.uniform()), y = double(rng.uniform());
            a[0][0] += x * x, a[1][0] += x * y, a[1][1] += y * y;
        }
        const SmallVector<double, 2> g = {double(rng.uniform(-2, 2)), double(rng.uniform(-2, 2))};
        const SmallVector<double, 2> x = {double(rng.uniform()), 4 * double(rng.uniform())};
        const auto out = bounded_step<double, 2>(a, SmallFactor<double, 2>(a, 1e-9), g, x, bounds);
        EXPECT_LE(out.change, 0);
        const auto value = [&](double s, double t) {
            return g[0] * s + g[1] * t + 0.5 * (a[0][0] * s * s + 2 * a[1][0] * s * t + a[1][1] * t * t);
        };
        EXPECT_NEAR(out.change, value(out.step[0], out.step[1]), 1e-9 * (1 + std::abs(out.change)));
        double lowest = 0;
        for (int i = 0; i <= 20; ++i)
            for (int j = 0; j <= 20; ++j) lowest = std::min(lowest, value(i / 20.0 - x[0], 4 * j / 20.0 - x[1]));
        EXPECT_LE(out.change, lowest * (1 - 1e-2) + 1e-9) << trial;
        for (size_t i = 0; i < 2; ++i) {
            const double to = x[i] + out.step[i];
            EXPECT_GE(to, bounds[i][0] - 1e-12);
            EXPECT_LE(to, bounds[i][1] + 1e-12);
            at_bound += to <= bounds[i][0] + 1e-12 || to >= bounds[i][1] - 1e-12 ? 1 : 0;
        }
    }
    EXPECT_GT(at_bound, 1000);
}

TEST(CeresTexel, ItsTwoLinearSolversAgree) {
    const TexelFitScene scene(32, 3, 30, 0.005, 15);
    for (size_t i = 0; i < scene.texels.size(); ++i) {
        Parameters start = scene.truth[i];
        start[8] = std::log(10.0);
        CeresTexelOptions options;
        const auto a = ceres_texels<Text>(options)->solve(scene.texels[i], start);
        options.linear = CeresTexelOptions::Linear::dense_qr;
        const auto b = ceres_texels<Text>(options)->solve(scene.texels[i], start);
        EXPECT_EQ(a.status, Status::stationary);
        EXPECT_NEAR(a.error, b.error, 1e-4 * a.error);
        EXPECT_NEAR(a.error, squared_error(a.parameters, scene.texels[i]), 1e-9 * a.error);
        EXPECT_NEAR(std::max(-a.parameters[6], a.parameters[7]), 1, 1e-9);
    }
    EXPECT_EQ(ceres_texels<Text>({})->solve({}, scene.truth[0]).status, Status::no_samples);
}

// A sample of weight two is that sample twice, for our start and for every rival.
TEST(CeresTexel, AWeightOfTwoIsTheSampleTwice) {
    const TexelModel& model = *find_texel_model("lafortune");
    Rng rng(21);
    const auto direction = [&] { return Vec3f(rng.uniform(-0.7f, 0.7f), rng.uniform(-0.7f, 0.7f), 0.8f).normalized(); };
    for (int texel = 0; texel < 12; ++texel) {
        std::vector<std::vector<ShadedSample>> weighted(1), twice(1), once(1);
        for (int i = 0; i < 60; ++i) {
            ShadedSample s{direction(), direction(), {}, 1};
            const float lobe = std::pow(std::max(0.0f, s.u.z() * s.v.z() - s.u.head(2).dot(s.v.head(2))), 12.0f);
            for (int c = 0; c < 3; ++c) s.target[c] = 0.2f + 0.1f * float(c) + 0.6f * lobe + rng.uniform(-0.05f, 0.05f);
            const bool heavy = i % 3 == 0;
            for (int copy = 0; copy < (heavy ? 2 : 1); ++copy) twice[0].push_back(s);
            once[0].push_back(s);
            s.weight = heavy ? 2 : 1;
            weighted[0].push_back(s);
        }
        const TexelSolvers& solvers = texel_solvers(model);
        const std::vector<float> start = solvers.start(twice), same = solvers.start(weighted);
        for (size_t i = 0; i < size_t(model.parameters); ++i)
            EXPECT_NEAR(same[i], start[i], 1e-3f * (1 + std::abs(start[i])));
        EXPECT_NE(solvers.start(once), start);
        using Method = CeresTexelOptions::Method;
        for (const Method method : {Method::whole, Method::projected, Method::tiny, Method::tiny_pack}) {
            const auto solver = ceres_texel_solver(model, {.method = method, .iterations = 200});
            const std::span<const float> from(start.data(), size_t(model.parameters));
            const CeresTexelFit a = solver->solve(weighted[0], from), b = solver->solve(twice[0], from),
                                c = solver->solve(once[0], from);
            EXPECT_NEAR(a.error, b.error, (method == Method::tiny_pack ? 1e-5 : 1e-6) * b.error)
                << texel << " " << int(method);
            EXPECT_LT(c.error, 0.95 * b.error);
        }
    }
}

// TinySolver and hand-made variable projection solve the same problem, so on nearly every texel they end at the same
// error; the latter in fewer iterations.
TEST(CeresTexel, ItsRivalsEndWhereItDoes) {
    const TexelFitScene scene(64, 3, 30, 0.005, 15);
    using Method = CeresTexelOptions::Method;
    double iterations[4] = {};
    const auto ceres = ceres_texels<Text>({});
    for (const Method method : {Method::projected, Method::tiny, Method::tiny_pack}) {
        const auto solver = ceres_texels<Text>({.method = method});  // uses again what it can from texel to texel
        const double rounding = method == Method::tiny_pack ? 1e-4 : 1e-6;
        int close = 0;
        for (size_t i = 0; i < scene.texels.size(); ++i) {
            Parameters start = scene.truth[i];
            start[8] = std::log(10.0);
            const auto whole = ceres->solve(scene.texels[i], start);
            const auto other = solver->solve(scene.texels[i], start);
            EXPECT_EQ(other.status, Status::stationary);
            EXPECT_NEAR(other.error, squared_error(other.parameters, scene.texels[i]), rounding * other.error);
            for (size_t k = 0; k < 9; ++k) {
                EXPECT_GE(other.parameters[k], TexelLocal<Text>::bounds(int(k))[0]);
                EXPECT_LE(other.parameters[k], TexelLocal<Text>::bounds(int(k))[1]);
            }
            close += other.error <= whole.error * (1 + 1e-4);
            iterations[int(method)] += other.iterations;
            if (method == Method::tiny) iterations[int(Method::whole)] += whole.iterations;
        }
        EXPECT_GE(close, 62) << int(method);
    }
    EXPECT_LT(iterations[int(Method::projected)], iterations[int(Method::whole)]);
}

}  // namespace
}  // namespace radiafit

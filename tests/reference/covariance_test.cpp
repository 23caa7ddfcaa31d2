// Error bars: of known matrices, of directions that no sample tells, and against the scatter of many fits.
#include "model/covariance.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "cpu/texel_covariance.h"
#include "model/texel_texts.h"
#include "reference/ceres_texel.h"
#include "texel_scene.h"

namespace radiafit {
using namespace fits;
namespace {

using testing::random_direction;

Eigen::MatrixXd random_matrix(Rng& rng, Eigen::Index rows, Eigen::Index columns) {
    Eigen::MatrixXd out(rows, columns);
    for (Eigen::Index i = 0; i < rows; ++i)
        for (Eigen::Index j = 0; j < columns; ++j) out(i, j) = double(rng.uniform(-1, 1));
    return out;
}

TEST(Covariance, IsTheInverseOfTheNormalMatrix) {
    Rng rng(1);
    Eigen::MatrixXd J = random_matrix(rng, 30, 6);
    J.col(2) *= 1e6;  // units don't matter
    const Covariance covariance = covariance_of(J.transpose() * J, 0.04);
    const Eigen::MatrixXd expected = 0.04 * (J.transpose() * J).inverse();
    EXPECT_EQ(covariance.deficient, 0);
    for (Eigen::Index i = 0; i < 6; ++i) {
        EXPECT_NEAR(covariance.deviation[size_t(i)] / std::sqrt(expected(i, i)), 1, 1e-9);
        for (Eigen::Index j = 0; j < 6; ++j)
            EXPECT_NEAR(covariance.matrix(i, j), expected(i, j), 1e-9 * std::sqrt(expected(i, i) * expected(j, j)));
    }
}

TEST(Covariance, FlagsDirectionsThatNoSampleTells) {
    Rng rng(2);
    Eigen::MatrixXd J = random_matrix(rng, 30, 5);
    J.col(3) = 2 * J.col(1);  // only p_1 + 2 p_3 is told
    const Covariance covariance = covariance_of(J.transpose() * J, 1);
    EXPECT_EQ(covariance.deficient, 1);
    for (const size_t i : {0u, 2u, 4u}) EXPECT_TRUE(std::isfinite(covariance.deviation[i])) << i;
    for (const size_t i : {1u, 3u}) EXPECT_TRUE(std::isinf(covariance.deviation[i])) << i;
    // what is told of them has its variance nevertheless
    Eigen::MatrixXd kept(30, 4);
    kept << J.leftCols(3), J.col(4);
    Eigen::VectorXd told = Eigen::VectorXd::Zero(5);
    told[1] = 1, told[3] = 2;
    EXPECT_NEAR(told.dot(covariance.matrix * told) / (kept.transpose() * kept).inverse()(1, 1), 1, 1e-4);
}

TEST(Covariance, AParameterWithoutEffectIsNotTold) {
    Eigen::MatrixXd normal = Eigen::MatrixXd::Identity(3, 3);
    normal(1, 1) = 0;
    const Covariance covariance = covariance_of(normal, 1);
    EXPECT_EQ(covariance.deficient, 1);
    EXPECT_DOUBLE_EQ(covariance.deviation[0], 1);
    EXPECT_TRUE(std::isinf(covariance.deviation[1]));
}

TEST(Covariance, AHeldParameterLeavesTheOthersAlone) {
    Rng rng(3);
    Eigen::MatrixXd J = random_matrix(rng, 30, 4);
    J.col(3) = J.col(0) + J.col(1);  // a gauge
    const Covariance covariance = covariance_of(J.transpose() * J, 1, {1});
    EXPECT_EQ(covariance.deficient, 0);
    EXPECT_EQ(covariance.deviation[1], 0);
    for (const size_t i : {0u, 2u, 3u}) EXPECT_TRUE(std::isfinite(covariance.deviation[i])) << i;
}

/// A sample of the model at p.
ShadedSample sample_of(const TexelModel& model, std::span<const float> p, const Vec3f& u, const Vec3f& v) {
    const auto value = model.value(p, u, v);
    return {u, v, {value[0], value[1], value[2]}, 1};
}
Vec3f direction(Rng& rng) {
    const auto d = random_direction(rng, 0.1);
    return Vec3f(float(d.x), float(d.y), float(d.z));
}
std::vector<ShadedSample> samples_of(Rng& rng, const TexelModel& model, std::span<const float> p, size_t count) {
    std::vector<ShadedSample> out;
    for (size_t i = 0; i < count; ++i) {
        const Vec3f u = direction(rng), v = direction(rng);
        out.push_back(sample_of(model, p, u, v));
    }
    return out;
}
double gauss(Rng& rng) {
    double sum = -6;
    for (int i = 0; i < 12; ++i) sum += double(rng.uniform());
    return sum;
}
/// Parameters in the midst of their bounds, canonical.
std::vector<float> some_parameters(Rng& rng, const TexelModel& model) {
    std::vector<float> p;
    for (const auto& [low, high] : model.bounds) {
        const double least = std::max(low, -1.0), most = std::min(high, least + 2);
        p.push_back(float(least + (most - least) * double(rng.uniform(0.3f, 0.7f))));
    }
    if (!model.starts.empty())
        for (int i = 0; i < model.shape; ++i) p[size_t(3 * model.basis + i)] = float(model.starts[1][size_t(i)]);
    model.make_canonical(p);
    return p;
}

TEST(TexelErrorBars, ColumnsAreTheDerivativesOfEveryModel) {
    Rng rng(4);
    for (const TexelModel* model : texel_models()) {
        SCOPED_TRACE(model->name);
        const std::vector<float> p = some_parameters(rng, *model);
        for (int trial = 0; trial < 20; ++trial) {
            const Vec3f u = direction(rng), v = direction(rng);
            std::vector<double> columns(size_t(model->columns()));
            model->columns(p, u, v, columns);
            for (size_t i = 0; i < p.size(); ++i) {
                constexpr float step = 1e-2f;
                auto more = p, less = p;
                more[i] += step, less[i] -= step;
                const auto above = model->value(more, u, v), below = model->value(less, u, v);
                for (size_t c = 0; c < 3; ++c) {
                    const double difference = double(above[c] - below[c]) / double(more[i] - less[i]);
                    const size_t linear = 3 * size_t(model->basis);
                    const double derivative = i >= linear ? double(p[linear - 3 + c]) * columns[i - linear + linear / 3]
                                              : i % 3 == c ? columns[i / 3]
                                                           : 0;
                    EXPECT_NEAR(derivative, difference, 2e-3 * std::max(1.0, std::abs(derivative))) << i << " " << c;
                }
            }
        }
    }
}

TEST(TexelErrorBars, ScatterOfManyFitsIsAsFarAsTheySay) {
    const TexelModel& model = *find_texel_model("lafortune");
    const size_t n = size_t(model.parameters);
    Rng rng(5);
    const std::vector<float> truth = {0.3f, 0.2f, 0.1f, 0.5f, 0.45f, 0.4f, -1, 0.9f, std::log(12.0f)};
    const std::vector<ShadedSample> exact = samples_of(rng, model, truth, 60);
    constexpr int draws = 400;
    constexpr double noise = 0.01;
    std::vector<double> squares(n, 0), predicted(n, 0);
    size_t within = 0, told = 0;
    for (int draw = 0; draw < draws; ++draw) {
        std::vector<ShadedSample> noisy = exact;
        for (ShadedSample& s : noisy)
            for (float& target : s.target) target += float(noise * gauss(rng));
        const CeresTexelFit fit = ceres_texel_solver(model, {.tolerance = 1e-10})->solve(noisy, truth);
        const TexelErrorBars bars = texel_error_bars(model, fit.parameters, noisy, {});
        EXPECT_NEAR(bars.noise, noise, 0.2 * noise);
        EXPECT_EQ(bars.covariance.deficient, 0);
        for (size_t i = 0; i < n; ++i) {
            const double off = double(fit.parameters[i]) - double(truth[i]), deviation = bars.covariance.deviation[i];
            squares[i] += off * off / draws;
            predicted[i] += deviation * deviation / draws;
            if (deviation > 0) ++told, within += std::abs(off) <= deviation;
        }
    }
    EXPECT_EQ(predicted[6], 0);  // held by the gauge
    for (size_t i = 0; i < n; ++i)
        for (size_t i = 0; i < n; ++i) {
            if (i == 6) continue;
            EXPECT_NEAR(std::sqrt(squares[i] / predicted[i]), 1, 0.15) << model.parameter_name(int(i));
        }
    EXPECT_NEAR(double(within) / double(told), 0.68, 0.03);
}

TEST(TexelErrorBars, ARobustLossCostsALittleCertainty) {
    const TexelModel& model = *find_texel_model("lambert");
    Rng rng(6);
    const std::vector<float> truth = {0.4f, 0.3f, 0.2f};
    std::vector<ShadedSample> samples = samples_of(rng, model, truth, 4000);
    for (ShadedSample& s : samples)
        for (float& target : s.target) target += float(0.02 * gauss(rng));
    const double plain = texel_error_bars(model, truth, samples, {}).covariance.deviation[0];
    for (const LossKind kind : {LossKind::huber, LossKind::cauchy}) {
        const double robust =
            texel_error_bars(model, truth, samples, {.kind = kind, .scale = 0.06f}).covariance.deviation[0];
        EXPECT_GT(robust, 0.99 * plain);
        EXPECT_LT(robust, 1.15 * plain);
    }
    // a tenth of the samples astray: squares think them noise, a robust loss hardly
    for (size_t i = 0; i < samples.size(); i += 10)
        for (float& target : samples[i].target) target += 1;
    const double astray = texel_error_bars(model, truth, samples, {}).covariance.deviation[0];
    EXPECT_GT(astray, 5 * plain);
    EXPECT_LT(
        texel_error_bars(model, truth, samples, {.kind = LossKind::cauchy, .scale = 0.06f}).covariance.deviation[0],
        2.5 * plain);
}

TEST(TexelErrorBars, WithoutHighlightsTheLobeIsNotTold) {
    const TexelModel& model = *find_texel_model("lafortune");
    Rng rng(7);
    const std::vector<float> matt = {0.3f, 0.2f, 0.1f, 0, 0, 0, -1, 1, std::log(20.0f)};
    const TexelErrorBars bars = texel_error_bars(model, matt, samples_of(rng, model, matt, 60), {});
    EXPECT_GE(bars.covariance.deficient, 2);  // Cz and log n
    EXPECT_TRUE(std::isfinite(bars.covariance.deviation[0]));
    EXPECT_TRUE(std::isinf(bars.covariance.deviation[8]));
    const TexelErrorBars few = texel_error_bars(model, matt, samples_of(rng, model, matt, 2), {});
    EXPECT_EQ(few.noise, 0);
    EXPECT_TRUE(std::isinf(few.covariance.deviation[0]));
}

}  // namespace
}  // namespace radiafit

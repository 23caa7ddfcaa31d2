// The per-problem texts and the optimizer loop, on problems whose answers are known.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "optim/optimizer.h"

namespace radiafit {
namespace {

using Text = ProblemText<double>;
using State = Text::ProblemState;

/// One problem in two unknowns with E, gradient and curvature given as functions: an Engine as small as can be.
struct TinyEngine {
    using Vec = std::array<double, 2>;
    std::function<double(const Vec&)> error;
    std::function<Vec(const Vec&)> gradient;
    std::function<double(const Vec&, const Vec&)> curvature;     ///< d'Hd at p
    std::function<double(const Vec&, const Vec&)> gauss_newton;  ///< d'J'Jd at p
    uint32_t samples = 1;

    Vec p{}, trial{}, d{}, g{}, trial_g{};
    State state{};
    double alpha = 0, trial_error = 0, norm = 0, cross = 0, conjugate = 0;
    Text::LineSums sums{};
    int line_passes = 0;

    size_t problem_count() const { return 1; }
    ProblemStatistics count() { return {{samples}, {0, 0, 0}}; }
    void reset(std::span<const float> start) {
        trial = {start[0], start[1]};
        p = trial;
        d = g = trial_g = {};
        state = {};
        state.error = 3.0e38;
        state.step_factor = 1;
        state.status = samples ? 0 : double(Status::no_samples);
    }
    void fit_terms(int, int) {}
    static double dot(const Vec& a, const Vec& b) { return a[0] * b[0] + a[1] * b[1]; }
    void direction_pass(bool) {
        trial_error = error(trial);
        trial_g = gradient(trial);
    }
    void project(Rule, bool) {
        norm = dot(trial_g, trial_g);
        cross = dot(trial_g, g);
        conjugate = dot(d, trial_g);
    }
    void after_direction(Rule rule, bool restart, ProblemText<float>::StopRules stop) {
        Text::after_direction(state, int(rule), restart, alpha, 1.0, {stop.residual, stop.output_change}, trial_error,
                              norm, cross, conjugate);
    }
    void update_direction(Rule, bool) {
        if (state.accepted != 0) p = trial, g = trial_g;
        for (int i = 0; i < 2; ++i) d[i] = state.beta * d[i] - g[i];
    }
    void line_pass() {
        ++line_passes;
        sums = {gauss_newton(p, d), curvature(p, d), 0, 0};
    }
    void after_line(Rule rule, ProblemText<float>::StopRules stop) {
        Text::after_line(state, alpha, int(rule), 1.0, {stop.residual, stop.output_change}, sums);
    }
    void advance() {
        const double step = Text::trial_step(state, alpha);
        for (int i = 0; i < 2; ++i) trial[i] = p[i] + step * d[i];
    }
    EngineSummary summary() const { return {state.error, uint64_t(state.status == 0), uint64_t(state.accepted)}; }
    void outcomes(std::span<ProblemOutcome> out) const {
        out[0] = {float(state.error), Status(int(state.status)), uint32_t(state.iterations)};
    }
    void read_errors(std::span<float> out) const { out[0] = float(state.error); }
    void read_parameters(std::span<float> out) const { out[0] = float(p[0]), out[1] = float(p[1]); }
};
static_assert(Engine<TinyEngine>);

/// E = 1/2 (x^2 + 10 (y - 1)^2 + 2 x (y - 1)): convex, minimum 0 at (0, 1).
TinyEngine quadratic() {
    TinyEngine e;
    e.error = [](auto& p) { return 0.5 * (p[0] * p[0] + 10 * (p[1] - 1) * (p[1] - 1) + 2 * p[0] * (p[1] - 1)); };
    e.gradient = [](auto& p) { return TinyEngine::Vec{p[0] + p[1] - 1, 10 * (p[1] - 1) + p[0]}; };
    e.curvature = [](auto&, auto& d) { return d[0] * d[0] + 10 * d[1] * d[1] + 2 * d[0] * d[1]; };
    e.gauss_newton = e.curvature;
    return e;
}
const std::vector<float> start = {3, -2};

TEST(Optimizer, ConjugateGradientsSolveTwoUnknownsInTwoSteps) {
    for (Rule rule : {Rule::cg_paper, Rule::cg_modern}) {
        TinyEngine e = quadratic();
        e.reset(start);
        const Trace trace = optimize(e, {.rule = rule, .iterations = 2, .refresh_every = 1000});
        EXPECT_EQ(trace.rows.size(), 3u);
        EXPECT_NEAR(e.p[0], 0, 1e-12);
        EXPECT_NEAR(e.p[1], 1, 1e-12);
        EXPECT_EQ(e.line_passes, 2);
    }
}

TEST(Optimizer, SteepestDescentKeepsItsFirstStepAndNeverClimbs) {
    TinyEngine e = quadratic();
    e.reset(start);
    const Trace trace = optimize(e, {.rule = Rule::steepest_descent, .iterations = 400});
    EXPECT_EQ(e.line_passes, 1);
    for (size_t k = 1; k < trace.rows.size(); ++k) EXPECT_LE(trace.rows[k].error, trace.rows[k - 1].error);
    EXPECT_NEAR(e.p[0], 0, 1e-4);
    EXPECT_NEAR(e.p[1], 1, 1e-4);
}

TEST(Optimizer, SteepestDescentHalvesWhenTheErrorRises) {
    TinyEngine e = quadratic();
    e.curvature = [](auto&, auto& d) { return 0.02 * (d[0] * d[0] + d[1] * d[1]); };  // a step about 500 times too long
    e.reset(start);
    const Trace trace = optimize(e, {.rule = Rule::steepest_descent, .iterations = 12});
    EXPECT_EQ(trace.rows[1].accepted, 0u);
    EXPECT_EQ(trace.rows[1].error, trace.rows[0].error);
    EXPECT_LT(e.state.step_factor, 0.01);
    EXPECT_LT(trace.rows.back().error, trace.rows[0].error);
}

TEST(Optimizer, ConjugateGradientsRestartThenHalve) {
    TinyEngine e = quadratic();
    const auto honest = e.curvature;
    int calls = 0;
    e.curvature = [&, honest](auto& p, auto& d) { return honest(p, d) * (++calls >= 2 && calls <= 4 ? 1e-3 : 1.0); };
    e.reset(start);
    std::vector<double> factor, beta;
    optimize(e, {.rule = Rule::cg_paper, .iterations = 5}, [&](int) {
        factor.push_back(e.state.step_factor);
        beta.push_back(e.state.beta);
    });
    EXPECT_GT(beta[1], 0);  // a conjugate step is tried and climbs ...
    EXPECT_EQ(beta[2], 0);  // ... so the direction becomes steepest, at full length ...
    EXPECT_EQ(factor[2], 1);
    EXPECT_EQ(factor[3], 0.5);  // ... which climbs too: halve, and halve again
    EXPECT_EQ(factor[4], 0.25);
    EXPECT_EQ(factor[5], 1);  // an accepted step restores the factor
    EXPECT_EQ(e.state.accepted, 1);
}

TEST(Optimizer, NegativeCurvatureFallsBackToGaussNewton) {
    TinyEngine e = quadratic();
    e.curvature = [](auto&, auto&) { return -5.0; };
    e.reset(start);
    const Trace trace = optimize(e, {.rule = Rule::cg_paper, .iterations = 2});
    EXPECT_EQ(trace.rows[1].accepted, 1u);
    EXPECT_NEAR(trace.rows.back().error, 0, 1e-12);
}

TEST(Optimizer, NotFiniteStartStopsTheProblem) {
    for (double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
        TinyEngine e = quadratic();
        e.error = [bad](auto&) { return bad; };
        e.reset(start);
        const Trace trace = optimize(e, {.iterations = 5});
        EXPECT_EQ(Status(int(e.state.status)), Status::not_finite);
        EXPECT_EQ(trace.rows.size(), 1u);
    }
}

TEST(Optimizer, NotFiniteTrialIsRejected) {
    TinyEngine e = quadratic();
    const auto honest = e.error;
    int calls = 0;
    e.error = [&, honest](auto& p) { return ++calls == 2 ? std::nan("") : honest(p); };
    e.reset(start);
    const Trace trace = optimize(e, {.rule = Rule::cg_paper, .iterations = 20});
    EXPECT_EQ(trace.rows[1].accepted, 0u);
    EXPECT_EQ(trace.rows[1].error, trace.rows[0].error);
    EXPECT_LT(trace.rows.back().error, 1e-6);
}

TEST(Optimizer, NoSamplesNeverMoves) {
    TinyEngine e = quadratic();
    e.samples = 0;
    e.reset(start);
    const Trace trace = optimize(e, {.iterations = 5});
    EXPECT_EQ(trace.rows.size(), 1u);
    EXPECT_EQ(Status(int(e.state.status)), Status::no_samples);
    EXPECT_EQ(e.p[0], 3);
}

TEST(Optimizer, StoppingRules) {
    TinyEngine by_residual = quadratic();
    by_residual.reset(start);
    optimize(by_residual, {.rule = Rule::steepest_descent, .iterations = 1000, .stop_residual = 0.1f});
    EXPECT_EQ(Status(int(by_residual.state.status)), Status::residual);
    EXPECT_LE(by_residual.state.error, 0.5 * 0.1 * 0.1 * (1 + 1e-6));

    for (Rule rule : {Rule::steepest_descent, Rule::cg_paper}) {
        TinyEngine by_change = quadratic();
        by_change.reset(start);
        const Trace trace = optimize(by_change, {.rule = rule, .iterations = 1000, .stop_output_change = 1e-3f});
        EXPECT_EQ(Status(int(by_change.state.status)), Status::output_change) << int(rule);
        EXPECT_LT(trace.rows.size(), 900u);
        EXPECT_GT(by_change.state.error, 0);
    }
}

TEST(Optimizer, StationaryWhenNoStepHelps) {
    TinyEngine e = quadratic();
    e.error = [first = true](auto&) mutable {
        const double x = first ? 1 : 2;
        first = false;
        return x;
    };
    e.reset(start);
    optimize(e, {.rule = Rule::cg_paper, .iterations = 100});
    EXPECT_EQ(Status(int(e.state.status)), Status::stationary);
    EXPECT_LT(e.state.iterations, 30);
}

/// The exact step against a fine scan of the quartic, over random bilinear line problems r + alpha a + alpha^2 b.
template <class real>
void exact_step_against_scan(double tolerance) {
    unsigned seed = 7;
    const auto uniform = [&] { return double((seed = seed * 1664525u + 1013904223u) >> 8) / (1 << 24) * 2 - 1; };
    for (int trial = 0; trial < 2000; ++trial) {
        double s1 = 0, aa = 0, rb = 0, ab = 0, bb = 0;
        const double bend = std::pow(10.0, 4 * uniform() - 3);  // from 1e-7 to 10
        for (int i = 0; i < 5; ++i) {
            const double r = uniform(), a = uniform(), b = uniform() * bend;
            s1 += r * a, aa += a * a, rb += r * b, ab += a * b, bb += b * b;
        }
        if (s1 > 0) s1 = -s1, ab = -ab;  // descend along d
        if (s1 == 0) continue;
        const typename ProblemText<real>::LineSums q{real(aa), real(aa + 2 * rb), real(ab), real(bb)};
        const auto change = [&](double x) { return x * (s1 + x * (0.5 * (aa + 2 * rb) + x * (ab + x * 0.5 * bb))); };
        const double unit = -s1 / aa;
        const double alpha = ProblemText<real>::exact_step(real(s1), q, real(unit));
        double best = 0;
        for (double x = 1e-3 * unit; x < 1e4 * unit; x *= 1.002) best = std::min(best, change(x));
        EXPECT_GT(alpha, 0) << trial;
        EXPECT_LE(change(alpha), best * (1 - tolerance))
            << "trial " << trial << " s1 " << s1 << " aa " << aa << " rb " << rb;
    }
}
// The scan's own resolution is 2e-6 of the change; float has 1e-7 per operation in a cubic whose terms may cancel.
TEST(Optimizer, ExactStepIsTheLowestMinimumInDouble) { exact_step_against_scan<double>(1e-5); }
TEST(Optimizer, ExactStepIsTheLowestMinimumInFloat) { exact_step_against_scan<float>(1e-3); }

}  // namespace
}  // namespace radiafit

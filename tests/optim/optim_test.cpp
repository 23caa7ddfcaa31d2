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

    std::vector<Vec> vectors = std::vector<Vec>(vector::first_own);
    Room room;
    State state{};
    std::vector<double> own, products;
    double trial_error = 0;
    Text::LineSums sums{};
    int line_passes = 0;

    const Vec& p() const { return vectors[vector::p]; }
    size_t problem_count() const { return 1; }
    ProblemStatistics count() { return {{samples}, {0, 0, 0}}; }
    void reset(std::span<const float> start) {
        vectors.assign(vector::first_own, Vec{});
        vectors[vector::p] = vectors[vector::trial] = {start[0], start[1]};
        state = {};
        state.error = 3.0e38;
        state.step_factor = 1;
        state.status = samples ? 0 : double(Status::no_samples);
    }
    void make_room(const Room& wanted) {
        room = wanted;
        vectors.resize(size_t(room.vector_count()));
        own.assign(size_t(room.numbers), 0);
        products.assign(size_t(room.product_count()), 0);
    }
    void fit_terms(int, int) {}
    void gradient_pass(bool diagonal) {
        trial_error = error(vectors[vector::trial]);
        vectors[vector::trial_g] = gradient(vectors[vector::trial]);
        if (diagonal) vectors[vector::fresh] = {1, 1};
    }
    void directional_pass() {
        ++line_passes;
        const Vec& d = vectors[vector::d];
        sums = {gauss_newton(p(), d), curvature(p(), d), 0, 0};
    }
    void dot(std::initializer_list<DotProduct> wanted) {
        for (const DotProduct& w : wanted) {
            double& sum = products[size_t(w.into)] = 0;
            for (size_t i = 0; i < 2; ++i)
                sum += vectors[size_t(w.a)][i] / (w.weight == vector::none ? 1 : vectors[size_t(w.weight)][i]) *
                       vectors[size_t(w.b)][i];
        }
    }
    void step(Step which, const Turn& turn) {
        Text::Own o{};
        std::copy(own.begin(), own.end(), o.x);
        Text::Given given{1.0, trial_error, sums, {}};
        std::copy_n(products.begin(), std::min(products.size(), std::size(given.products)), given.products);
        const Text::Turn here{turn.rule,     turn.restart,   turn.slot, {turn.stop.residual, turn.stop.output_change},
                              turn.left_out, turn.first_step};
        switch (which) {
#define RADIAFIT_CASE(file, function)          \
    case Step::function:                       \
        Text::function(state, o, given, here); \
        break;
            RADIAFIT_STEPS(RADIAFIT_CASE)
#undef RADIAFIT_CASE
        }
        std::copy_n(o.x, own.size(), own.begin());
    }
    double number_of(int n) const {
        const double fields[] = {state.error,    state.norm,   state.slope,      state.step_factor, state.beta,
                                 state.accepted, state.status, state.iterations, state.alpha,       state.taken};
        return n >= number::first_product ? products[size_t(n - number::first_product)]
               : n >= number::first_own   ? own[size_t(n - number::first_own)]
                                          : fields[n];
    }
    void update(Update which, std::initializer_list<int> list, std::initializer_list<int> numbers,
                std::initializer_list<float> constants) {
        EXPECT_EQ(int(list.size()), updates[int(which)].vectors);
        EXPECT_EQ(int(numbers.size()), updates[int(which)].numbers + updates[int(which)].products);
        for (size_t i = 0; i < 2; ++i) {
            Text::Elements e{};
            Text::Registers r{};
            Text::Constants told{};
            for (size_t k = 0; k < list.size(); ++k) e.x[k] = vectors[size_t(std::data(list)[k])][i];
            for (size_t k = 0; k < numbers.size(); ++k) r.x[k] = number_of(std::data(numbers)[k]);
            std::copy(constants.begin(), constants.end(), told.x);
            switch (which) {
#define RADIAFIT_CASE(file, function, ...) \
    case Update::function:                 \
        Text::function(e, r, told);        \
        break;
                RADIAFIT_UPDATES(RADIAFIT_CASE)
#undef RADIAFIT_CASE
            }
            for (size_t k = 0; k < size_t(updates[int(which)].written); ++k)
                vectors[size_t(std::data(list)[k])][i] = e.x[k];
        }
    }
    EngineSummary summary() const { return {state.error, uint64_t(state.status == 0), uint64_t(state.accepted)}; }
    void outcomes(std::span<ProblemOutcome> out) const {
        out[0] = {float(state.error), Status(int(state.status)), uint32_t(state.iterations)};
    }
    void read_errors(std::span<float> out) const { out[0] = float(state.error); }
    void read_parameters(std::span<float> out) const { out[0] = float(p()[0]), out[1] = float(p()[1]); }
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
        EXPECT_NEAR(e.p()[0], 0, 1e-12);
        EXPECT_NEAR(e.p()[1], 1, 1e-12);
        EXPECT_EQ(e.line_passes, 2);
    }
}

TEST(Optimizer, SteepestDescentKeepsItsFirstStepAndNeverClimbs) {
    TinyEngine e = quadratic();
    e.reset(start);
    const Trace trace = optimize(e, {.rule = Rule::steepest_descent, .iterations = 400});
    EXPECT_EQ(e.line_passes, 1);
    for (size_t k = 1; k < trace.rows.size(); ++k) EXPECT_LE(trace.rows[k].error, trace.rows[k - 1].error);
    EXPECT_NEAR(e.p()[0], 0, 1e-4);
    EXPECT_NEAR(e.p()[1], 1, 1e-4);
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

/// The paper's text without our corrections.
TEST(Optimizer, MendsCanBeLeftOut) {
    const auto run = [](TinyEngine e, const OptimizerOptions& options) {
        e.reset(start);
        const Trace trace = optimize(e, options);
        return std::pair(trace, e);
    };
    const OptimizerOptions paper = {.rule = Rule::cg_paper, .iterations = 40};

    OptimizerOptions printed = paper;  // climbs, restarts, halves, and never leaves its start
    printed.left_out = WITHOUT_SIGN;
    const auto [signs, stuck] = run(quadratic(), printed);
    EXPECT_EQ(signs.rows.back().error, signs.rows[0].error);
    EXPECT_EQ(Status(int(stuck.state.status)), Status::stationary);

    TinyEngine hill = quadratic();
    hill.curvature = [](auto&, auto&) { return -5.0; };
    OptimizerOptions bare = paper;
    bare.left_out = WITHOUT_GAUSS_NEWTON;
    const auto [bends, climbed] = run(hill, bare);
    EXPECT_LT(climbed.state.alpha, 0);
    EXPECT_EQ(bends.rows.back().error, bends.rows[0].error);

    // An uphill direction's own minimum lies behind it.
    TinyEngine e = quadratic();
    e.reset(start);
    e.trial_error = 1;
    e.state.error = 2;
    e.state.norm = 1;
    e.products = {1, 0, 5};  // slope -1 + 5 beta, beta = 1
    for (const bool mended : {true, false}) {
        TinyEngine f = e;
        const Turn turn = {RULE_CG_PAPER, 0, 0, {0, 0}, mended ? 0 : WITHOUT_DOWNHILL, 0};
        f.step(Step::judge_trial, turn);
        EXPECT_EQ(f.state.beta, mended ? 0 : 1);
        EXPECT_EQ(f.state.slope, mended ? -1 : 4);
        f.sums = {2, 2, 0, 0};
        f.step(Step::step_length, turn);
        EXPECT_EQ(f.state.alpha, mended ? 0.5 : -2);
    }

    TinyEngine steep = quadratic();
    steep.curvature = [](auto&, auto& d) { return 0.02 * (d[0] * d[0] + d[1] * d[1]); };
    OptimizerOptions once = {.rule = Rule::steepest_descent, .iterations = 12};
    once.left_out = WITHOUT_RETRY;
    EXPECT_EQ(run(steep, once).first.rows.size(), 2u);

    OptimizerOptions given = {.rule = Rule::steepest_descent, .iterations = 3};
    given.left_out = WITHOUT_MEASURED_STEP;
    given.first_step = 0.01f;
    EXPECT_EQ(run(quadratic(), given).second.state.alpha, 0.01f);

    given.iterations = 200;
    const double fixed = run(quadratic(), given).first.rows.back().error;
    given.left_out |= WITHOUT_FIXED_STEP;  // grows out of a first step that is much too small
    const auto [trace, grown] = run(quadratic(), given);
    EXPECT_LT(trace.rows.back().error, 0.1 * fixed);
    EXPECT_GT(grown.state.step_factor, 1);
    for (size_t k = 1; k < trace.rows.size(); ++k) EXPECT_LE(trace.rows[k].error, trace.rows[k - 1].error);
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
    EXPECT_EQ(e.p()[0], 3);
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

/// Curved, with its minimum 0 at (1, 1), and convex where it is used.
TinyEngine valley() {
    TinyEngine e;
    using Vec = TinyEngine::Vec;
    e.error = [](const Vec& p) {
        return 2 * std::pow(p[1] - p[0] * p[0], 2) + 0.5 * std::pow(p[0] - 1, 2) + 0.1 * std::pow(p[1] - 1, 4);
    };
    e.gradient = [](const Vec& p) {
        const double t = p[1] - p[0] * p[0];
        return Vec{-8 * p[0] * t + p[0] - 1, 4 * t + 0.4 * std::pow(p[1] - 1, 3)};
    };
    e.curvature = [](const Vec& p, const Vec& d) {
        const double xx = -8 * (p[1] - p[0] * p[0]) + 16 * p[0] * p[0] + 1, xy = -8 * p[0],
                     yy = 4 + 1.2 * std::pow(p[1] - 1, 2);
        return xx * d[0] * d[0] + 2 * xy * d[0] * d[1] + yy * d[1] * d[1];
    };
    e.gauss_newton = e.curvature;
    return e;
}

/// L-BFGS against the inverse Hessian written out as a matrix, built anew from the last pairs by BFGS' own formula, and
/// the same steps, taken here.
TEST(Optimizer, LimitedMemoryBfgsIsBfgsOfTheLastPairs) {
    using Vec = TinyEngine::Vec;
    using Matrix = std::array<Vec, 2>;
    const auto dot = [](const Vec& a, const Vec& b) { return a[0] * b[0] + a[1] * b[1]; };
    const auto times = [&](const Matrix& m, const Vec& x) { return Vec{dot(m[0], x), dot(m[1], x)}; };
    for (const int history : {1, 2, 5}) {
        TinyEngine e = valley();
        const std::vector<float> begin = {0.5f, 0.5f};
        std::vector<std::pair<Vec, Vec>> pairs;
        Vec p = {begin[0], begin[1]}, g = e.gradient(p);
        std::vector<Vec> path = {p};
        for (int k = 0; k < 5; ++k) {
            Matrix inverse = {Vec{1, 0}, Vec{0, 1}};
            const size_t first = pairs.size() - std::min(pairs.size(), size_t(history));
            for (size_t i = first; i < pairs.size(); ++i) {
                const auto& [s, y] = pairs[i];
                const double rho = 1 / dot(s, y);
                Matrix left, next;  // (1 - rho s y') H (1 - rho y s') + rho s s'
                for (size_t a = 0; a < 2; ++a)
                    for (size_t b = 0; b < 2; ++b) left[a][b] = (a == b) - rho * s[a] * y[b];
                for (size_t a = 0; a < 2; ++a)
                    for (size_t b = 0; b < 2; ++b)
                        next[a][b] = dot(left[a], times(inverse, left[b])) + rho * s[a] * s[b];
                inverse = next;
            }
            Vec d = times(inverse, g);
            for (double& x : d) x = -x;
            const double step = -dot(d, g) / e.curvature(p, d);
            const Vec q = {p[0] + step * d[0], p[1] + step * d[1]};
            ASSERT_LT(e.error(q), e.error(p)) << "no rejection is part of this test";
            const Vec h = e.gradient(q);
            pairs.push_back({{q[0] - p[0], q[1] - p[1]}, {h[0] - g[0], h[1] - g[1]}});
            p = q, g = h;
            path.push_back(p);
        }
        e.reset(begin);
        size_t k = 0;
        optimize(
            e, {.rule = Rule::lbfgs, .iterations = 5, .refresh_every = 1000, .first_refresh = 1000, .history = history},
            [&](int) {
                for (int i = 0; i < 2; ++i) EXPECT_NEAR(e.p()[size_t(i)], path[k][size_t(i)], 1e-9) << k;
                ++k;
            });
        EXPECT_EQ(k, path.size());
        EXPECT_LT(e.state.error, 1e-3);
    }
}

TEST(Optimizer, LimitedMemoryBfgsGoesOnAfterARejection) {
    TinyEngine e = valley();
    const auto honest = e.curvature;
    int calls = 0;
    e.curvature = [&](auto& p, auto& d) { return (++calls == 2 ? 0.02 : 1) * honest(p, d); };  // 50 times too far
    e.reset({{0.5f, 0.5f}});
    const Trace trace = optimize(e, {.rule = Rule::lbfgs, .iterations = 40});
    EXPECT_EQ(trace.rows[2].accepted, 0u);
    EXPECT_EQ(trace.rows[2].error, trace.rows[1].error);
    EXPECT_LT(trace.rows.back().error, 1e-8);
}

TEST(Optimizer, AdamFollowsItsFormulasAndKeepsTheBest) {
    TinyEngine e = valley();
    const double rate = 0.3f;  // so large that errors rise, too
    double x[2] = {0.5, 0.5}, mean[2] = {}, square[2] = {}, best = e.error({x[0], x[1]});
    int rises = 0;
    e.reset({{0.5f, 0.5f}});
    optimize(e, {.rule = Rule::adam, .iterations = 30, .learning_rate = float(rate)}, [&](int k) {
        if (k > 0) {
            const auto g = e.gradient({x[0], x[1]});
            for (size_t i = 0; i < 2; ++i) {
                mean[i] = 0.9 * mean[i] + 0.1 * g[i];
                square[i] = 0.999 * square[i] + 0.001 * g[i] * g[i];
                x[i] -=
                    rate * mean[i] / (1 - std::pow(0.9, k)) / (std::sqrt(square[i] / (1 - std::pow(0.999, k))) + 1e-8);
            }
        }
        const auto& trial = e.vectors[vector::trial];
        for (size_t i = 0; i < 2; ++i) EXPECT_NEAR(trial[i], x[i], 1e-4) << k;  // its constants are floats
        rises += e.error(trial) > best;
        best = std::min(best, e.error(trial));
        EXPECT_NEAR(e.state.error, best, 1e-12);
        EXPECT_NEAR(e.error(e.p()), best, 1e-12);
    });
    EXPECT_GT(rises, 3);
    EXPECT_LT(best, 0.05);
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
TEST(Trace, TellsHowASolverEnded) {
    Trace trace{{{.iteration = 0, .error = 8}}};
    EXPECT_EQ(ending_of(trace, 3, 3), "");
    trace.rows.push_back({.iteration = 1, .error = 4});
    trace.rows.push_back({.iteration = 2, .error = 3.9});
    EXPECT_EQ(ending_of(trace, 3, 3), "all 2 iterations used, the last lowered the error by 2.5 %");
    EXPECT_EQ(ending_of(trace, 1, 3), "1 of 3 problems used all 2 iterations, the last lowered the error by 2.5 %");
    EXPECT_EQ(ending_of(trace, 0, 3), "all problems done after 2 iterations");
    trace.rows[1].error = trace.rows[2].error = 0;
    EXPECT_EQ(ending_of(trace, 3, 3), "all 2 iterations used, the last lowered the error by 0 %");
}

TEST(Optimizer, ExactStepIsTheLowestMinimumInDouble) { exact_step_against_scan<double>(1e-5); }
TEST(Optimizer, ExactStepIsTheLowestMinimumInFloat) { exact_step_against_scan<float>(1e-3); }

}  // namespace
}  // namespace radiafit

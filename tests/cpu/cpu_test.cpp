// The CPU engine: against a naive oracle, against finite differences, and against known answers.
#include <gtest/gtest.h>

#include "base/parallel.h"
#include "bench/lfm_oracle.h"
#include "cpu/lfm_engine.h"
#include "model/lfm_start.h"
#include "optim/optimizer.h"
#include "scenes.h"

namespace radiafit {
using namespace harness;
namespace {

struct EngineScene : testing::SampledScene {
    explicit EngineScene(const LfmOptions& o, uint64_t seed = 1)
        : SampledScene(o, testing::sheet_dataset(testing::troubled_mesh(4, 23, seed), 12, 64, seed),
                       [&](const TriangleAtlas& tiles, const Dataset&) {
                           return testing::random_samples(tiles, 12, 0.7f, seed);
                       }) {}
};

template <class real>
std::vector<Lanes<real>> random_lanes(size_t count, float low, float high, uint64_t seed) {
    std::vector<Lanes<real>> out(count);
    Rng rng(seed);
    for (auto& x : out) x = Lanes<real>{rng.uniform(low, high), rng.uniform(low, high), rng.uniform(low, high), 0};
    return out;
}
template <class real>
std::vector<double> flat(const std::vector<Lanes<real>>& x) {
    std::vector<double> out;
    for (const auto& v : x)
        for (int c = 0; c < 4; ++c) out.push_back(double(v[c]));
    return out;
}

LfmOptions plain(int terms = 1, ViewLookup lookup = ViewLookup::bilinear) {
    LfmOptions o;
    o.terms = terms;
    o.surface_side = 5;
    o.view_side = 4;
    o.lookup = lookup;
    o.lambda_surface = o.lambda_view = o.mu = 0;
    return o;
}

template <class real>
void against_oracle(const LfmOptions& options, double tolerance) {
    EngineScene scene(options);
    LfmProblem<real> problem(scene.dataset, scene.atlas, scene.rings, scene.samples, options);
    const auto statistics = problem.count();
    const LfmLayout& layout = problem.layout();
    const auto p = random_lanes<real>(layout.size() / 4, -0.5f, 1.5f, 5);
    const auto d = random_lanes<real>(layout.size() / 4, -1.0f, 1.0f, 6);
    const auto truth = lfm_oracle(scene.dataset, scene.atlas, scene.rings, layout, options, scene.samples,
                                  flat<real>(p), flat<real>(d));
    ASSERT_EQ(statistics.samples, truth.samples);
    size_t checked = 0;
    for (size_t v = 0; v < layout.problem_count(); ++v) {
        const size_t begin = layout.offset(v) / 4, size = layout.block_size(v) / 4;
        std::vector<Lanes<real>> g(size), diagonal(size);
        double error[3];
        problem.direction(v, &p[begin], g.data(), diagonal.data(), error);
        LineLanes line;
        problem.line(v, &p[begin], &d[begin], line);
        const double density = truth.samples[v] ? double(truth.samples[v]) / double(problem.texels(v)) : 1;
        const auto expect = [&](const ExactSum& sum, double value, const char* what) {
            ASSERT_TRUE(std::isfinite(value)) << what;
            ASSERT_NEAR(value * density, sum.value, tolerance * sum.magnitude + 1e-30) << what << " of vertex " << v;
            ++checked;
        };
        for (int c = 0; c < 3; ++c) {
            expect(truth.error[3 * v + c], error[c], "error");
            expect(truth.gauss_newton[3 * v + c], line.gauss_newton[c], "J'J");
            expect(truth.curvature[3 * v + c], line.curvature[c], "d'Hd");
            expect(truth.third[3 * v + c], line.third[c], "third");
            expect(truth.fourth[3 * v + c], line.fourth[c], "fourth");
            double largest = 0;
            for (size_t i = 0; i < size; ++i)
                largest = std::max(largest, truth.diagonal[layout.offset(v) + 4 * i + c].value);
            for (size_t i = 0; i < size; ++i) {
                expect(truth.gradient[layout.offset(v) + 4 * i + c], g[i][c], "gradient");
                const double floored =
                    std::max(truth.diagonal[layout.offset(v) + 4 * i + c].value, 1e-4 * largest) / density;
                ASSERT_NEAR(diagonal[i][c], floored, 2 * tolerance * floored + 1e-29);
            }
        }
        for (size_t i = 0; i < size; ++i) ASSERT_EQ(g[i][3], 0) << "padding";
    }
    EXPECT_GT(checked, layout.size() / 4 * 3) << "less than a gradient";
}

// Tolerances are shares of the sum of the terms' magnitudes: 1e-5 is what a chain of some hundred 2^-24 roundings may
// reach; in double what remains is the float footprint both sides share.
TEST(CpuEngine, FloatMatchesOracle) {
    for (int terms : {1, 2, 3, 5}) against_oracle<float>(plain(terms), 1e-5);
    against_oracle<float>(plain(2, ViewLookup::nearest), 1e-5);
}
TEST(CpuEngine, DoubleMatchesOracle) {
    for (int terms : {1, 2, 4}) against_oracle<double>(plain(terms), 1e-12);
    against_oracle<double>(plain(1, ViewLookup::nearest), 1e-12);
}
TEST(CpuEngine, MapsOfTheirOwnSidesMatchTheOracle) {
    const Mesh mesh = testing::troubled_mesh(4, 23, 1);  // EngineScene's
    for (int terms : {1, 3}) {
        against_oracle<float>(testing::with_own_sides(plain(terms), mesh), 1e-5);
        against_oracle<double>(testing::with_own_sides(plain(terms), mesh), 1e-12);
    }
}
TEST(CpuEngine, RobustLossesMatchTheOracle) {
    for (const LossKind kind : {LossKind::huber, LossKind::cauchy})
        for (const int terms : {1, 5}) {
            LfmOptions options = plain(terms);
            options.loss = {kind, 0.4f};
            against_oracle<float>(options, 1e-5);
            against_oracle<double>(options, 1e-12);
        }
}
TEST(CpuEngine, WeightsMatchTheOracle) {
    for (const LossKind kind : {LossKind::square, LossKind::huber, LossKind::cauchy})
        for (const int terms : {1, 2}) {
            LfmOptions options = plain(terms);
            options.loss = {kind, 0.4f, SampleWeights::facing};
            against_oracle<float>(options, 1e-5);
            against_oracle<double>(options, 1e-6);  // the oracle's look-ups are weighted in float
        }
}
/// A tenth of the samples is nonsense: a robust fit is near the one without them, a fit of squares is not.
TEST(CpuEngine, RobustLossesLeaveOutliersAside) {
    const LfmOptions options = plain(1);
    EngineScene scene(options);
    for (Sample& s : scene.samples.samples)
        for (uint16_t& x : s.rgb) x = 20000;
    SampleList clean = scene.samples;
    for (size_t i = 0; i < scene.samples.samples.size(); i += 10)
        for (uint16_t& x : scene.samples.samples[i].rgb) x = 65535;
    const auto fitted = [&](const SampleList& samples, const Loss& loss) {
        LfmOptions with = options;
        with.loss = loss;
        LfmProblem<float> problem(scene.dataset, scene.atlas, scene.rings, samples, with);
        StreamEngine<float> engine(problem);
        engine.reset(lfm_start(problem.layout(), engine.count().mean, 1));
        optimize(engine, {.iterations = 40});
        LfmProblem<double> truth(scene.dataset, scene.atlas, scene.rings, clean, options);
        StreamEngine<double> judge(truth);
        judge.count();
        std::vector<float> p(problem.layout().size());
        engine.read_parameters(p);
        judge.reset(p);
        return optimize(judge, {.iterations = 0}).rows[0].error;
    };
    const float scale = 0.02f * float(clean.scale) * 65535;
    const double squares = fitted(scene.samples, {});
    EXPECT_LT(fitted(scene.samples, {LossKind::huber, scale}), squares / 2);  // outliers go on pulling, by a constant
    EXPECT_LT(fitted(scene.samples, {LossKind::cauchy, scale}), squares / 10);
}

TEST(CpuEngine, FiniteDifferencesInDouble) {
    for (Mode mode : {Mode::paper, Mode::modern})
        for (int terms : {1, 2}) {
            LfmOptions options = plain(terms);
            options.mode = mode;
            options.lambda_surface = 0.3f, options.lambda_view = 0.2f, options.mu = 0.7f;
            options.lower = 0, options.upper = 1;
            EngineScene scene(options);
            LfmProblem<double> problem(scene.dataset, scene.atlas, scene.rings, scene.samples, options);
            problem.count();
            const LfmLayout& layout = problem.layout();
            const size_t v = 7;
            const size_t size = layout.block_size(v) / 4;
            auto p = random_lanes<double>(size, -0.4f, 1.6f, 11);
            for (auto& x : p)  // away from the bounds, where E_b has a kink (paper) or its curvature jumps (modern)
                for (int c = 0; c < 3; ++c)
                    for (double bound : {0.0, 1.0})
                        if (std::abs(x[c] - bound) < 1e-3) x[c] = bound + 2e-3;
            const auto d = random_lanes<double>(size, -1, 1, 12);
            const auto value = [&](double alpha, std::vector<Lanes<double>>* gradient = nullptr) {
                auto q = p;
                for (size_t i = 0; i < size; ++i) q[i] += alpha * d[i];
                std::vector<Lanes<double>> g(size);
                double e[3];
                problem.direction(v, q.data(), g.data(), nullptr, e);
                if (gradient) *gradient = g;
                return Lanes<double>{e[0], e[1], e[2], 0};
            };
            std::vector<Lanes<double>> g, ahead, behind;
            const Lanes<double> e0 = value(0, &g);
            const double h = 1e-5;
            const Lanes<double> slope_fd = (value(h, &ahead) - value(-h, &behind)) / (2 * h);
            Lanes<double> slope{}, curvature_fd{};
            for (size_t i = 0; i < size; ++i)
                slope += g[i] * d[i], curvature_fd += (ahead[i] - behind[i]) * d[i] / (2 * h);
            LineLanes line;
            problem.line(v, p.data(), d.data(), line);
            for (int c = 0; c < 3; ++c) {
                EXPECT_NEAR(slope[c], slope_fd[c], 1e-7 * std::abs(slope[c]) + 1e-7);
                EXPECT_NEAR(line.curvature[c], curvature_fd[c], 1e-7 * line.curvature[c]);
                // the quartic is exact where no bound is crossed
                const double alpha = 5e-4;
                const double quartic =
                    e0[c] + alpha * (slope[c] + alpha * (line.curvature[c] / 2 +
                                                         alpha * (line.third[c] + alpha * line.fourth[c] / 2)));
                EXPECT_NEAR(value(alpha)[c], quartic, 1e-12 * e0[c]);
            }
            // every single gradient entry
            for (size_t i = 0; i < size; ++i) {
                auto q = p;
                double plus[3], minus[3];
                std::vector<Lanes<double>> unused(size);
                q[i] = p[i] + Lanes<double>{h, h, h, 0};
                problem.direction(v, q.data(), unused.data(), nullptr, plus);
                q[i] = p[i] - Lanes<double>{h, h, h, 0};
                problem.direction(v, q.data(), unused.data(), nullptr, minus);
                for (int c = 0; c < 3; ++c)
                    EXPECT_NEAR(g[i][c], (plus[c] - minus[c]) / (2 * h), 1e-6 * (1 + std::abs(g[i][c])));
            }
        }
}

/// Samples of a light field that K terms represent exactly: targets computed from known maps, per triangle, such that
/// L t = sum_k g_k h_k holds for all three corners at once: one view dependence h(v) = const per image direction.
TEST(CpuEngine, RecoversAnExactlyRepresentableLightField) {
    // One triangle pair per problem would make the three corners' problems disagree, so only vertex 0 of a one-triangle
    // mesh is asked for: its weight L is not constant, which g absorbs.
    LfmOptions options = plain(1);
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.triangles = {{0, 1, 2}};
    const Dataset dataset = testing::sheet_dataset(mesh, 60, 64, 3);
    const TriangleAtlas atlas(dataset.mesh, options.surface_side);
    const VertexRings rings(dataset.mesh);
    const auto frames = vertex_frames(dataset.mesh);
    Rng rng(4);
    std::vector<std::array<float, 3>> albedo(atlas.texels_per_tile());
    std::vector<std::array<float, 3>> lobe(16);
    for (auto& a : albedo) a = {rng.uniform(0.2f, 0.9f), rng.uniform(0.2f, 0.9f), rng.uniform(0.2f, 0.9f)};
    for (auto& l : lobe) l = {rng.uniform(0.3f, 1), rng.uniform(0.3f, 1), rng.uniform(0.3f, 1)};
    SampleList list;
    list.tile_groups = {0};
    for (uint32_t image = 0; image < 60; ++image) {
        list.views.push_back(image);
        list.groups.push_back({image, uint32_t(list.samples.size())});
        const ViewFootprint f =
            view_footprint(frames[0], mesh.positions[0], dataset.views[image].camera.center(), 4, options.lookup);
        for (uint32_t local = 0; local < atlas.texels_per_tile(); ++local) {
            Sample s{{0, 0, 0}, uint16_t(local)};
            for (int c = 0; c < 3; ++c) {
                const float h = f.weight[0] * lobe[f.texel][c] + f.weight[1] * lobe[f.texel + 1][c] +
                                f.weight[2] * lobe[f.texel + 4][c] + f.weight[3] * lobe[f.texel + 5][c];
                s.rgb[c] = uint16_t(albedo[local][c] * h * 65535 + 0.5f);
            }
            list.samples.push_back(s);
        }
    }
    list.tile_groups.push_back(uint32_t(list.groups.size()));
    list.groups.push_back({0, uint32_t(list.samples.size())});

    // in double: the residual falls below what 32-bit sums of E can tell apart
    LfmProblem<double> problem(dataset, atlas, rings, list, options);
    StreamEngine<double> engine(problem);
    const auto statistics = engine.count();
    for (Rule rule : {Rule::cg_modern, Rule::cg_paper}) {
        engine.reset(lfm_start(problem.layout(), statistics.mean, 1));
        optimize(engine, {.rule = rule, .iterations = rule == Rule::cg_modern ? 300 : 2000});
        std::vector<float> p(problem.layout().size());
        engine.read_parameters(p);
        double worst = 0;
        for (uint32_t image = 0; image < 60; ++image) {
            const ViewFootprint f =
                view_footprint(frames[0], mesh.positions[0], dataset.views[image].camera.center(), 4, options.lookup);
            for (uint32_t local = 0; local < atlas.texels_per_tile(); ++local)
                for (int c = 0; c < 3; ++c) {
                    const float* h = &p[problem.layout().view_offset(0) + 4 * f.texel + c];
                    const float value = p[4 * local + c] * (f.weight[0] * h[0] + f.weight[1] * h[4] +
                                                            f.weight[2] * h[16] + f.weight[3] * h[20]);
                    const double target = atlas.tile(0).barycentric(local)[0] *
                                          list.samples[image * atlas.texels_per_tile() + local].rgb[c] / 65535.0;
                    worst = std::max(worst, std::abs(value - target) / target);
                }
        }
        EXPECT_LT(worst, 1e-3) << "rule " << int(rule);
    }
}

TEST(CpuEngine, SameBitsForAnyThreadCountAndTwice) {
    LfmOptions options = plain(2);
    options.lambda_surface = options.lambda_view = 1e-3f;
    EngineScene scene(options);
    std::vector<std::vector<float>> results;
    for (int threads : {1, 2, 2}) {
        set_thread_count(threads);
        LfmProblem<float> problem(scene.dataset, scene.atlas, scene.rings, scene.samples, options);
        StreamEngine<float> engine(problem);
        engine.reset(lfm_start(problem.layout(), engine.count().mean, 1));
        optimize(engine, {.iterations = 12});
        results.emplace_back(problem.layout().size());
        engine.read_parameters(results.back());
    }
    set_thread_count(0);
    EXPECT_EQ(results[0], results[1]);
    EXPECT_EQ(results[1], results[2]);
    for (float x : results[0]) ASSERT_TRUE(std::isfinite(x));
}

TEST(CpuEngine, ProblemsWithoutSamplesAreNamedAndStay) {
    EngineScene scene(plain());
    LfmProblem<float> problem(scene.dataset, scene.atlas, scene.rings, scene.samples, scene.options);
    StreamEngine<float> engine(problem);
    const auto statistics = engine.count();
    engine.reset(lfm_start(problem.layout(), statistics.mean, 1));
    optimize(engine, {.iterations = 3});
    std::vector<ProblemOutcome> outcomes(engine.problem_count());
    engine.outcomes(outcomes);
    const size_t unreferenced = scene.dataset.mesh.vertex_count() - 1;
    EXPECT_EQ(statistics.samples[unreferenced], 0u);
    EXPECT_EQ(outcomes[3 * unreferenced].status, Status::no_samples);
    EXPECT_EQ(outcomes[0].status, Status::max_iterations);
    EXPECT_EQ(outcomes[0].iterations, 3u);
}

/// All rules find the same minimum of a small regularized problem, and modern CG needs the fewest iterations.
TEST(CpuEngine, RulesAgreeOnTheMinimum) {
    LfmOptions options = plain();
    options.lambda_surface = options.lambda_view = 1e-2f;
    EngineScene scene(options);
    LfmProblem<double> problem(scene.dataset, scene.atlas, scene.rings, scene.samples, options);
    StreamEngine<double> engine(problem);
    const auto start = lfm_start(problem.layout(), engine.count().mean, 1);
    const auto least = [&](Rule rule, int iterations) {
        engine.reset(start);
        return optimize(engine, {.rule = rule, .iterations = iterations, .learning_rate = 0.002f}).rows.back().error;
    };
    const double error = least(Rule::cg_modern, 400);
    for (const Rule rule : {Rule::cg_paper, Rule::lbfgs}) EXPECT_NEAR(least(rule, 400), error, 1e-3 * error);
    for (const Rule rule : {Rule::steepest_descent, Rule::adam}) EXPECT_NEAR(least(rule, 4000), error, 2e-2 * error);
}

}  // namespace
}  // namespace radiafit

// Variable projection: the derivatives of min_g E_t(g, h) against differences, and what a minimizer must do.
#include "base/error.h"
#include "base/parallel.h"
#include "reference/als_solver.h"
#include "reference/ceres_solver.h"
#include "reference/projected_energy.h"
#include "reference/varpro_solver.h"
#include "reference_scene.h"

namespace radiafit {
using namespace fits;
using namespace harness;
namespace {

using namespace testing;

/// 1e-5 of the sum of magnitudes: 32-bit sums over some hundred products.
TEST(SchurLanes, AddsUpSystems) {
    for (const auto& [rows, columns, band] : {std::array<size_t, 3>{7, 1, 2}, {36, 18, 14}, {21, 41, 20}, {5, 64, 0}}) {
        Rng rng(columns);
        SchurLanes schur(rows, columns);
        std::vector<double> expected(3 * columns * columns), magnitude(expected.size());
        for (int system = 0; system < 2; ++system) {
            LaneCholesky l(rows, band);
            for (size_t i = 0; i < rows; ++i)
                for (size_t j = i > band ? i - band : 0; j <= i; ++j)
                    for (int c = 0; c < 3; ++c)
                        l.at(i, j)[c] = double(rng.uniform(-1, 1)) + (i == j ? 2.0 * double(band) + 3 : 0);
            ASSERT_EQ(l.factor(), 0u);
            schur.clear_x();
            std::vector<std::vector<V>> x(columns, std::vector<V>(rows));
            for (size_t j = 0; j < columns; ++j)
                for (size_t i = 0; i < rows; ++i) {
                    x[j][i] = V{rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1), 0};
                    schur.x(i, j) = __builtin_convertvector(x[j][i], Lanes<float>);
                }
            std::vector<std::vector<V>> solved = x;
            for (auto& column : solved) l.solve(column.data());
            schur.add(l);
            for (size_t m = 0; m < columns; ++m)
                for (size_t n = 0; n <= m; ++n)
                    for (size_t i = 0; i < rows; ++i)
                        for (size_t c = 0; c < 3; ++c) {
                            const double term = x[m][i][long(c)] * solved[n][i][long(c)];
                            expected[3 * (m * columns + n) + c] += term;
                            magnitude[3 * (m * columns + n) + c] += std::abs(term);
                        }
        }
        for (size_t m = 0; m < columns; ++m)
            for (size_t n = 0; n <= m; ++n)
                for (size_t c = 0; c < 3; ++c) {
                    const size_t at = 3 * (m * columns + n) + c;
                    ASSERT_NEAR(double(schur.at(m, n)[long(c)]), expected[at], 1e-5 * magnitude[at]) << m << " " << n;
                }
    }
}

/// F at a view map, and the parameters there.
struct At {
    V error;
    std::vector<V> p, gradient;
};
At at(const LfmVertex& vertex, ProjectedEnergy& energy, std::vector<V> p) {
    EXPECT_TRUE(energy.evaluate(p.data()));
    At out{energy.error(), p, {}};
    for (size_t i = 0; i < p.size() - vertex.view_begin(); ++i) out.gradient.push_back(energy.gradient(i));
    return out;
}

class Projected : public ::testing::TestWithParam<std::tuple<int, ViewLookup, bool>> {};
TEST_P(Projected, DerivativesAgainstDifferences) {
    const auto [terms, lookup, own_sides] = GetParam();
    LfmOptions options = smooth(terms, lookup);
    options.lower = -50, options.upper = 50;  // far from the kinks of E_b
    if (own_sides) options = testing::with_own_sides(options, testing::troubled_mesh(3, 7, 1));
    const Scene scene(options);
    const LfmVertex vertex = scene.gather(scene.vertex_with_samples(5));
    const TileSmoothness tiles(options);
    const Smoothness view(*vertex.view);
    ProjectedEnergy energy(vertex, tiles, view);
    const auto p = random_block(vertex.size(), 3);
    const At here = at(vertex, energy, p);
    const size_t size = here.gradient.size();
    std::vector<std::vector<V>> hessian(size, std::vector<V>(size));
    V largest{}, steepest{};
    for (size_t i = 0; i < size; ++i) {
        for (size_t j = 0; j <= i; ++j) hessian[i][j] = hessian[j][i] = energy.hessian(i, j);
        largest = energy.diagonal(i) > largest ? energy.diagonal(i) : largest;
        for (int c = 0; c < 3; ++c) steepest[c] = std::max(steepest[c], std::abs(here.gradient[i][c]));
    }
    const V again = lfm_error(vertex, here.p.data());
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(here.error[c], again[c], 1e-12 * again[c]);
    const double h = 1e-4;
    for (size_t j = 0; j < size; ++j) {
        std::vector<V> ends[2] = {p, p};
        ends[0][vertex.view_begin() + j] -= broadcast3(h);
        ends[1][vertex.view_begin() + j] += broadcast3(h);
        const At minus = at(vertex, energy, ends[0]), plus = at(vertex, energy, ends[1]);
        for (int c = 0; c < 3; ++c) {
            ASSERT_NEAR(here.gradient[j][c], (plus.error[c] - minus.error[c]) / (2 * h), 1e-5 * steepest[c]);
            for (size_t i = 0; i < size; ++i)
                ASSERT_NEAR(hessian[i][j][c], (plus.gradient[i][c] - minus.gradient[i][c]) / (2 * h), 1e-5 * largest[c])
                    << i << " " << j;
        }
    }
}
INSTANTIATE_TEST_SUITE_P(Cases, Projected,
                         ::testing::Combine(::testing::Values(1, 2, 3, 4),
                                            ::testing::Values(ViewLookup::bilinear, ViewLookup::nearest),
                                            ::testing::Bool()));

TEST(ProjectedEnergy, SurfaceMapsAreTheBestUnderActiveBounds) {
    LfmOptions options = smooth(2);
    options.lower = 0.3f, options.upper = 0.4f;
    const Scene scene(options);
    const size_t v = scene.vertex_with_samples(5);
    const LfmVertex vertex = scene.gather(v);
    const TileSmoothness tiles(options);
    const Smoothness view(*vertex.view);
    ProjectedEnergy energy(vertex, tiles, view);
    const auto p = random_block(vertex.size(), 8);
    const At here = at(vertex, energy, p);
    const Truth truth = truth_of(scene, v, here.p);
    size_t beyond = 0;
    for (size_t i = 0; i < vertex.view_begin(); ++i) {
        beyond += i % 2 == 0 && (here.p[i][0] < 0.3 || here.p[i][0] > 0.4);
        for (int c = 0; c < 3; ++c) ASSERT_NEAR(truth.gradient[i][c], 0, 1e-9 * truth.magnitude[i][c]) << i;
    }
    EXPECT_GT(beyond, 0u) << "the bounds are meant to be active";
}

/// Some tens of trials to a gradient that is next to nothing, at the one minimum of a single term. Several terms have
/// several minima, and with four little data holds a vertex here: the valleys are long.
TEST(Varpro, LowersTheErrorAndSaysWhatItReturns) {
    for (int terms : {1, 2, 4})
        for (ViewLookup lookup : {ViewLookup::bilinear, ViewLookup::nearest})
            for (float upper : {16.0f, 0.4f}) {
                LfmOptions options = smooth(terms, lookup);
                options.upper = upper;
                const Scene scene(options);
                const size_t v = scene.vertex_with_samples(5);
                SCOPED_TRACE(std::to_string(terms) + " terms, upper bound " + std::to_string(upper));
                VertexRun run, alternating;
                const auto p = solve_one(scene, v, varpro_solver(options, {.iterations = 60}), run);
                solve_one(scene, v, als_solver(options, {60, 0, 0}), alternating);
                const auto start =
                    block_of(scene, lfm_start(scene.vertices.layout(), scene.vertices.statistics().mean, 1), v);
                const Truth truth = truth_of(scene, v, p);
                for (int c = 0; c < 3; ++c) {
                    const auto& channel = run.channel[c];
                    EXPECT_TRUE(channel.status == Status::stationary || channel.iterations() == 60);
                    EXPECT_EQ(channel.error.size(), channel.time_s.size());
                    EXPECT_TRUE(std::is_sorted(channel.error.rbegin(), channel.error.rend()));
                    EXPECT_NEAR(channel.error.back(), truth.error[c], 1e-9 * truth.error[c]);
                    EXPECT_LT(channel.error.back(), 0.1 * channel.error.front());
                    if (terms == 1) {
                        EXPECT_LT(channel.error.back(), 1.0001 * alternating.channel[c].error.back());
                    }
                    if (terms < 4) {
                        EXPECT_LT(gradient_norm(scene, v, p, c), 1e-3 * gradient_norm(scene, v, start, c));
                    }
                    for (const V& x : p) ASSERT_EQ(x[3], 0);
                }
            }
}

TEST(Varpro, EndsWhereCeresDoes) {
    const Scene scene(smooth());
    for (size_t from : {0, 5, 17}) {
        const size_t v = scene.vertex_with_samples(from);
        VertexRun own, ceres;
        solve_one(scene, v, varpro_solver(scene.options, {.iterations = 100}), own);
        solve_one(scene, v, ceres_solver(scene.options, {"sparse-normal-cholesky", 3000, 0}), ceres);
        for (int c = 0; c < 3; ++c) {
            const double best = ceres.channel[c].error.back();
            EXPECT_NEAR(own.channel[c].error.back(), best, 1e-4 * best) << v;
        }
    }
}

TEST(Varpro, EveryVertexOfATroubledMesh) {
    const Scene scene(smooth());
    RunsResult results[2];
    for (int threads : {1, 2}) {
        set_thread_count(threads);
        results[threads - 1] = solve_vertices(scene.vertices, 1, varpro_solver(scene.options, {.iterations = 30}));
    }
    set_thread_count(0);
    EXPECT_EQ(results[0].parameters, results[1].parameters);
    const RunsResult als = solve_vertices(scene.vertices, 1, als_solver(scene.options, {30, 0, 0}));
    double own = 0, alternating = 0;
    for (size_t v = 0; v < als.runs.size(); ++v)
        for (int c = 0; c < 3; ++c) {
            if (als.runs[v].channel[c].error.empty()) continue;
            own += results[0].runs[v].channel[c].error.back();
            alternating += als.runs[v].channel[c].error.back();
        }
    EXPECT_GT(own, 0);
    EXPECT_LT(own, alternating);
}

TEST(Varpro, StopsWhereItIsToldTo) {
    const Scene scene(smooth());
    const size_t v = scene.vertex_with_samples(5);
    VertexRun free, stopped, capped;
    solve_one(scene, v, varpro_solver(scene.options, {.iterations = 50}), free);
    ASSERT_GT(free.channel[0].iterations(), 3u);
    const double level = free.channel[0].error[2], texels = double(scene.gather(v).surface_texels());
    solve_one(scene, v,
              varpro_solver(scene.options, {.iterations = 50, .stop_residual = std::sqrt(2.000001 * level / texels)}),
              stopped);
    EXPECT_EQ(stopped.channel[0].status, Status::residual);
    EXPECT_EQ(stopped.channel[0].iterations(), 2u);
    solve_one(scene, v, varpro_solver(scene.options, {.iterations = 2}), capped);
    EXPECT_EQ(capped.channel[0].status, Status::max_iterations);
    EXPECT_EQ(capped.channel[0].iterations(), 2u);
    LfmOptions paper = scene.options;
    paper.mode = Mode::paper;
    EXPECT_THROW(varpro_solver(paper, {}), UserError);
    paper.mu = 0;
    EXPECT_NO_THROW(varpro_solver(paper, {}));
    LfmOptions large = scene.options;
    large.view_side = 64;
    EXPECT_THROW(varpro_solver(large, {}), UserError);
}

}  // namespace
}  // namespace radiafit

// Reference solvers (Ceres, alternating least squares): the objective they minimize against the engines' one, and what
// a minimizer must do.
#include <ceres/crs_matrix.h>
#include <ceres/problem.h>
#include <gtest/gtest.h>

#include "base/error.h"
#include "base/parallel.h"
#include "reference/als_solver.h"
#include "reference/ceres_blocks.h"
#include "reference/ceres_solver.h"
#include "reference/channel_energy.h"
#include "reference/lane_cholesky.h"
#include "reference_scene.h"

namespace radiafit {
using namespace fits;
using namespace harness;
namespace {

using namespace testing;

/// Diagonally dominant systems, condition numbers below 10: A times the solution gives b back.
TEST(LaneCholesky, Solves) {
    for (const auto& [size, band] : {std::pair<size_t, size_t>{1, 0}, {7, 2}, {40, 9}, {33, 33}}) {
        Rng rng(size);
        LaneCholesky cholesky(size, band);
        std::vector<V> dense(size * size), b(size);
        for (size_t i = 0; i < size; ++i) {
            for (size_t j = i > band ? i - band : 0; j <= i; ++j)
                for (int c = 0; c < 3; ++c)
                    cholesky.at(i, j)[c] = dense[i * size + j][c] = dense[j * size + i][c] =
                        double(rng.uniform(-1, 1)) + (i == j ? 2.0 * double(band) + 3 : 0);
            b[i] = V{rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1), 0};
        }
        ASSERT_EQ(cholesky.factor(), 0u);
        std::vector<V> x = b;
        cholesky.solve(x.data());
        for (size_t i = 0; i < size; ++i) {
            V product{};
            for (size_t j = 0; j < size; ++j) product += dense[i * size + j] * x[j];
            for (int c = 0; c < 3; ++c) ASSERT_NEAR(product[c], b[i][c], 1e-13);
            ASSERT_EQ(x[i][3], 0);
        }
    }
}

TEST(LaneCholesky, SaysWhereAMatrixIsNotPositiveDefinite) {
    LaneCholesky cholesky(2, 1);
    for (int c = 0; c < 3; ++c) cholesky.at(0, 0)[c] = cholesky.at(1, 1)[c] = 1;
    cholesky.at(1, 0)[2] = 2;
    EXPECT_EQ(cholesky.factor(), 4u);
}

/// Cost and gradient of a CeresVertex at x.
std::pair<double, std::vector<double>> ceres_gradient(CeresVertex& ceres, const std::vector<double>& x) {
    std::ranges::copy(x, ceres.x().begin());
    ceres::Problem::EvaluateOptions options;
    options.parameter_blocks = ceres.surface();
    options.parameter_blocks.insert(options.parameter_blocks.end(), ceres.view().begin(), ceres.view().end());
    double cost = 0;
    std::vector<double> gradient;
    EXPECT_TRUE(ceres.problem().Evaluate(options, &cost, nullptr, &gradient, nullptr));
    return {cost, gradient};
}

// 1e-9 of the sum of magnitudes: double rounding over some thousand terms stays far below; a wrong term doesn't.
TEST(Reference, EveryFormOfTheObjectiveIsTheEngines) {
    for (int terms : {1, 2, 3, 4})
        for (ViewLookup lookup : {ViewLookup::bilinear, ViewLookup::nearest}) {
            LfmOptions options = smooth(terms, lookup);
            if (terms % 2 == 0) options = testing::with_own_sides(options, testing::troubled_mesh(3, 7, 1));
            const Scene scene(options);
            for (size_t v : {scene.vertex_with_samples(), scene.vertex_with_samples(17)}) {
                const LfmVertex vertex = scene.gather(v);
                const auto p = random_block(vertex.size(), 3);
                const Truth truth = truth_of(scene, v, p);
                const V error = lfm_error(vertex, p.data());
                CeresVertex texels(vertex, CeresBlocks::texels), maps(vertex, CeresBlocks::maps);
                for (int c = 0; c < 3; ++c) {
                    const auto x = channel_of(p, c);
                    const ChannelEnergy energy(vertex, c);
                    std::vector<double> gradient(x.size());
                    const auto same = [&](double e, const std::vector<double>& g, const char* what) {
                        ASSERT_EQ(g.size(), x.size());
                        ASSERT_NEAR(e, truth.error[c], 1e-9 * truth.error[c]) << what;
                        for (size_t i = 0; i < x.size(); ++i)
                            ASSERT_NEAR(g[i], truth.gradient[i][c], 1e-9 * truth.magnitude[i][c]) << what << " " << i;
                    };
                    EXPECT_NEAR(error[c], truth.error[c], 1e-9 * truth.error[c]);
                    EXPECT_NEAR(energy.evaluate(x.data(), nullptr), truth.error[c], 1e-9 * truth.error[c]);
                    same(energy.evaluate(x.data(), gradient.data()), gradient, "one pass");
                    texels.set_channel(c);
                    maps.set_channel(c);
                    const auto [e, g] = ceres_gradient(texels, x);
                    same(e, g, "blocks of texels");
                    const auto [e2, g2] = ceres_gradient(maps, x);
                    same(e2, g2, "blocks of maps");
                }
            }
        }
}

TEST(Reference, ObjectiveWithoutPenalties) {
    LfmOptions options = smooth(2);
    options.lambda_surface = options.lambda_view = options.mu = 0;
    const Scene scene(options);
    const size_t v = scene.vertex_with_samples();
    const LfmVertex vertex = scene.gather(v);
    const auto p = random_block(vertex.size(), 4);
    const Truth truth = truth_of(scene, v, p);
    for (CeresBlocks blocks : {CeresBlocks::texels, CeresBlocks::maps}) {
        CeresVertex ceres(vertex, blocks);
        ceres.set_channel(1);
        const auto [e, g] = ceres_gradient(ceres, channel_of(p, 1));
        EXPECT_NEAR(e, truth.error[1], 1e-9 * truth.error[1]);
        for (size_t i = 0; i < g.size(); ++i)
            ASSERT_NEAR(g[i], truth.gradient[i][1], 1e-9 * truth.magnitude[i][1] + 1e-15);
    }
}

/// Residuals are bilinear, so central differences leave nothing but rounding: 1e-16 / h.
TEST(Reference, CeresJacobianAgainstDifferences) {
    for (CeresBlocks blocks : {CeresBlocks::texels, CeresBlocks::maps}) {
        const Scene scene(smooth(2));
        const LfmVertex vertex = scene.gather(scene.vertex_with_samples());
        CeresVertex ceres(vertex, blocks);
        ceres.set_channel(2);
        ceres::Problem::EvaluateOptions options;
        options.parameter_blocks = ceres.surface();
        options.parameter_blocks.insert(options.parameter_blocks.end(), ceres.view().begin(), ceres.view().end());
        const double h = 1e-4;
        auto x = channel_of(random_block(vertex.size(), 9), 2);
        for (double& value : x)  // away from the kinks of dist(p, [0, 1])
            for (double bound : {0.0, 1.0})
                if (std::abs(value - bound) < 10 * h) value = bound + 20 * h;
        std::ranges::copy(x, ceres.x().begin());
        ceres::CRSMatrix sparse;
        std::vector<double> residuals;
        ASSERT_TRUE(ceres.problem().Evaluate(options, nullptr, &residuals, nullptr, &sparse));
        ASSERT_GT(residuals.size(), vertex.sample_count());
        std::vector<std::vector<double>> jacobian(x.size(), std::vector<double>(residuals.size()));
        for (int r = 0; r < sparse.num_rows; ++r)
            for (int i = sparse.rows[size_t(r)]; i < sparse.rows[size_t(r) + 1]; ++i)
                jacobian[size_t(sparse.cols[size_t(i)])][size_t(r)] += sparse.values[size_t(i)];
        const auto at = [&](size_t i, double value) {
            ceres.x()[i] = value;
            std::vector<double> r;
            EXPECT_TRUE(ceres.problem().Evaluate(options, nullptr, &r, nullptr, nullptr));
            ceres.x()[i] = x[i];
            return r;
        };
        for (size_t i = 0; i < x.size(); ++i) {
            const auto plus = at(i, x[i] + h), minus = at(i, x[i] - h);
            for (size_t r = 0; r < plus.size(); ++r) ASSERT_NEAR(jacobian[i][r], (plus[r] - minus[r]) / (2 * h), 1e-10);
        }
    }
}

TEST(Ceres, EverySettingReachesTheSameMinimum) {
    const Scene scene(smooth());
    const size_t v = scene.vertex_with_samples(5);
    VertexRun best;
    for (const CeresSetting& setting : ceres_settings()) {
        SCOPED_TRACE(setting.name);
        VertexRun run;
        const auto p = solve_one(scene, v, ceres_solver(scene.options, {setting.name, 3000, 0}), run);
        const Truth truth = truth_of(scene, v, p);
        for (int c = 0; c < 3; ++c) {
            const auto& channel = run.channel[c];
            ASSERT_GT(channel.error.size(), 2u);
            ASSERT_EQ(channel.error.size(), channel.time_s.size());
            EXPECT_TRUE(std::is_sorted(channel.error.rbegin(), channel.error.rend()));
            EXPECT_TRUE(std::is_sorted(channel.time_s.begin(), channel.time_s.end()));
            EXPECT_NEAR(channel.error.back(), truth.error[c], 1e-12) << "what it says is what it returns";
            // line searches end where a step no longer shows in the cost
            if (best.channel[c].error.empty()) continue;
            EXPECT_NEAR(channel.error.back(), best.channel[c].error.back(), 1e-4 * best.channel[c].error.back());
        }
        if (best.channel[0].error.empty()) best = run;
    }
}

TEST(Ceres, SameMinimumWithTwoTermsAndActiveBounds) {
    LfmOptions options = smooth(2);
    options.upper = 0.4f;  // below the mean of the view maps' start
    const Scene scene(options);
    const size_t v = scene.vertex_with_samples(5);
    for (const char* setting : {"sparse-normal-cholesky", "dense-schur-maps"}) {
        VertexRun run;
        const auto p = solve_one(scene, v, ceres_solver(options, {setting, 500, 0}), run);
        size_t beyond = 0;
        for (size_t i = 0; i < p.size(); i += 2) beyond += p[i][0] > 0.4;
        EXPECT_GT(beyond, 0u) << "the bounds are meant to be active";
        auto start = block_of(scene, lfm_start(scene.vertices.layout(), scene.vertices.statistics().mean, 1), v);
        for (int c = 0; c < 3; ++c)
            EXPECT_LT(gradient_norm(scene, v, p, c), 1e-3 * gradient_norm(scene, v, start, c)) << setting;
    }
}

TEST(Ceres, StopsAtAResidualAndSaysSo) {
    const Scene scene(smooth());
    const size_t v = scene.vertex_with_samples(5);
    VertexRun free, stopped;
    solve_one(scene, v, ceres_solver(scene.options, {"sparse-normal-cholesky", 50, 0}), free);
    const double texels = double(scene.gather(v).surface_texels());
    const double level = free.channel[0].error[1];  // reached by the first step
    solve_one(scene, v, ceres_solver(scene.options, {"sparse-normal-cholesky", 50, std::sqrt(2.1 * level / texels)}),
              stopped);
    EXPECT_EQ(stopped.channel[0].status, Status::residual);
    EXPECT_EQ(stopped.channel[0].iterations(), 1u);
    VertexRun capped;
    solve_one(scene, v, ceres_solver(scene.options, {"lbfgs", 2, 0}), capped);
    EXPECT_EQ(capped.channel[0].status, Status::max_iterations);
    EXPECT_EQ(capped.channel[0].iterations(), 2u);
}

TEST(Ceres, RefusesWhatItCannotDo) {
    LfmOptions options = smooth();
    EXPECT_THROW(ceres_solver(options, {"dense-shur", 5, 0}), UserError);
    options.mode = Mode::paper;
    EXPECT_THROW(ceres_solver(options, {}), UserError);
    EXPECT_THROW(als_solver(options, {}), UserError);
    options.mu = 0;
    EXPECT_NO_THROW(ceres_solver(options, {}));
    EXPECT_NO_THROW(als_solver(options, {}));
}

TEST(Als, NeverRaisesTheErrorAndEndsStationary) {
    for (int terms : {1, 2, 4})
        for (ViewLookup lookup : {ViewLookup::bilinear, ViewLookup::nearest})
            for (float upper : {16.0f, 0.4f}) {  // the second: bounds are active
                LfmOptions options = smooth(terms, lookup);
                options.upper = upper;
                if (terms == 2) options = testing::with_own_sides(options, testing::troubled_mesh(3, 7, 1));
                const Scene scene(options);
                const size_t v = scene.vertex_with_samples(5);
                VertexRun run;
                // several terms share what the samples hold, and alternation goes slowly along such valleys
                const double share = terms == 1 ? 1e-4 : 1e-2;
                const auto p = solve_one(scene, v, als_solver(options, {terms == 1 ? 2000 : 500, 0, 1e-15}), run);
                const auto start =
                    block_of(scene, lfm_start(scene.vertices.layout(), scene.vertices.statistics().mean, 1), v);
                const Truth truth = truth_of(scene, v, p);
                for (int c = 0; c < 3; ++c) {
                    const auto& errors = run.channel[c].error;
                    ASSERT_GT(errors.size(), 2u);
                    EXPECT_TRUE(std::is_sorted(errors.rbegin(), errors.rend()));
                    EXPECT_NEAR(errors.back(), truth.error[c], 1e-12);
                    EXPECT_LT(gradient_norm(scene, v, p, c), share * gradient_norm(scene, v, start, c))
                        << terms << " terms, channel " << c << ", " << errors.size() << " rows";
                }
            }
}

TEST(Als, HoldsWhatNothingElseDoes) {
    LfmOptions options = smooth();
    options.view_side = 9;  // more texels than the views reach
    options.lambda_surface = options.lambda_view = options.mu = 0;
    const Scene scene(options);
    const size_t v = scene.vertex_with_samples();
    LfmVertex vertex = scene.gather(v);
    VertexRun run;
    const auto p = solve_one(scene, v, als_solver(options, {20, 0, 0}), run);
    const auto start = block_of(scene, lfm_start(scene.vertices.layout(), scene.vertices.statistics().mean, 1), v);
    std::vector<bool> seen(vertex.view->texel_count());
    for (const auto& g : vertex.groups)
        for (int j = 0; j < 4; ++j)
            if (g.weight[j] != 0) seen[vertex.corner(g, j)] = true;
    size_t unseen = 0;
    for (size_t t = 0; t < seen.size(); ++t)
        if (!seen[t]) {
            ++unseen;
            for (int c = 0; c < 3; ++c) {  // but for the rounding of one division and one product
                EXPECT_NEAR(p[vertex.view_begin() + t][c], start[vertex.view_begin() + t][c], 1e-14);
            }
        }
    EXPECT_GT(unseen, 0u);
    for (const V& value : p)
        for (int c = 0; c < 3; ++c) ASSERT_TRUE(std::isfinite(value[c]));
}

/// One triangle whose light field is surface map times view map exactly.
TEST(Reference, RecoversAnExactlyRepresentableLightField) {
    LfmOptions options = smooth();
    options.lambda_surface = options.lambda_view = options.mu = 0;
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.triangles = {{0, 1, 2}};
    const Dataset dataset = testing::sheet_dataset(mesh, 60, 64, 3);
    const TriangleAtlas atlas(dataset.mesh, options.surface_side);
    const VertexRings rings(dataset.mesh);
    const auto frames = vertex_frames(dataset.mesh);
    Rng rng(4);
    std::vector<float> albedo(3 * atlas.texels_per_tile()), lobe(3 * 16);
    for (float& a : albedo) a = rng.uniform(0.2f, 0.9f);
    for (float& l : lobe) l = rng.uniform(0.3f, 1);
    SampleList list;
    list.tile_groups = {0};
    for (uint32_t image = 0; image < 60; ++image) {
        list.views.push_back(image);
        list.groups.push_back({image, uint32_t(list.samples.size())});
        const ViewFootprint f =
            view_footprint(frames[0], mesh.positions[0], dataset.views[image].camera.center(), 4, options.lookup);
        for (uint32_t local = 0; local < atlas.texels_per_tile(); ++local) {
            Sample s{{0, 0, 0}, uint16_t(local)};
            for (uint32_t c = 0; c < 3; ++c) {
                const auto h = [&](uint32_t texel) { return lobe[3 * texel + c]; };
                const float value = f.weight[0] * h(f.texel) + f.weight[1] * h(f.texel + 1u) +
                                    f.weight[2] * h(f.texel + 4u) + f.weight[3] * h(f.texel + 5u);
                s.rgb[c] = uint16_t(albedo[3 * local + c] * value * 65535 + 0.5f);
            }
            list.samples.push_back(s);
        }
    }
    list.tile_groups.push_back(uint32_t(list.groups.size()));
    list.groups.push_back({0, uint32_t(list.samples.size())});

    const LfmVertices vertices(dataset, atlas, rings, list, options);
    LfmVertex vertex;
    vertices.gather(0, vertex);
    const LfmLayout& layout = vertices.layout();
    const std::vector<float> start = lfm_start(layout, vertices.statistics().mean, 1);
    for (const VertexSolver& solver :
         {als_solver(options, {400, 0, 0}), ceres_solver(options, {"sparse-normal-cholesky", 100, 0}),
          ceres_solver(options, {"lbfgs", 1000, 0})}) {
        std::vector<V> p(vertex.size());
        for (size_t i = 0; i < p.size(); ++i)
            for (int c = 0; c < 4; ++c) p[i][c] = double(start[4 * i + size_t(c)]);
        VertexRun run;
        solver(vertex, p, run);
        double worst = 0;
        for (size_t i = 0; i + 1 < vertex.groups.size(); ++i) {
            const auto& g = vertex.groups[i];
            for (uint32_t s = g.first; s < vertex.groups[i + 1].first; ++s)
                for (int c = 0; c < 3; ++c) {
                    double h = 0;
                    for (int j = 0; j < 4; ++j) h += g.weight[j] * p[vertex.view_begin() + vertex.corner(g, j)][c];
                    const double target = vertex.target[s][c];
                    worst = std::max(worst, std::abs(p[vertex.local[s]][c] * h - target) / target);
                }
        }
        EXPECT_LT(worst, 1e-3);  // targets are rounded to 16 bits
    }
}

TEST(VertexRuns, WholeMeshWithEveryTrouble) {
    const Scene scene(smooth());
    RunsResult results[2];
    for (int threads : {1, 2}) {
        set_thread_count(threads);
        results[threads - 1] = solve_vertices(scene.vertices, 1, als_solver(scene.options, {6, 0, 0}));
    }
    set_thread_count(0);
    EXPECT_EQ(results[0].parameters, results[1].parameters);
    const LfmLayout& layout = scene.vertices.layout();
    const auto start = lfm_start(layout, scene.vertices.statistics().mean, 1);
    double sum = 0;
    size_t without = 0;
    for (size_t v = 0; v < layout.problem_count(); ++v) {
        const auto& channel = results[0].runs[v].channel[0];
        if (scene.vertices.statistics().samples[v]) {
            EXPECT_EQ(channel.status, Status::max_iterations);
            EXPECT_EQ(channel.iterations(), 6u);
            for (const auto& c : results[0].runs[v].channel) sum += c.error.back();
            continue;
        }
        ++without;
        EXPECT_EQ(channel.status, Status::no_samples);
        for (size_t i = layout.offset(v); i < layout.offset(v + 1); ++i) EXPECT_EQ(results[0].parameters[i], start[i]);
    }
    EXPECT_GT(without, 0u);
    const Trace trace = trace_of(results[0].runs, 1);
    ASSERT_EQ(trace.rows.size(), 7u);
    EXPECT_NEAR(trace.rows[6].error, sum, 1e-12 * sum);
    EXPECT_EQ(trace.rows[6].active, 0u);
    EXPECT_EQ(trace.rows[0].active, 3 * (layout.problem_count() - without));
    for (size_t k = 1; k < 7; ++k) {
        EXPECT_LT(trace.rows[k].error, trace.rows[k - 1].error);
        EXPECT_GT(trace.rows[k].time_s, trace.rows[k - 1].time_s);
    }

    const std::vector<uint32_t> chosen = {uint32_t(scene.vertex_with_samples(5))};
    const RunsResult one = solve_vertices(scene.vertices, 1, als_solver(scene.options, {6, 0, 0}), &chosen);
    for (size_t v = 0; v < layout.problem_count(); ++v) {
        const auto& expected = v == chosen[0] ? results[0].parameters : start;
        for (size_t i = layout.offset(v); i < layout.offset(v + 1); ++i) ASSERT_EQ(one.parameters[i], expected[i]);
    }
}

TEST(VertexRuns, TimesAddUpByChannelOrGoSideBySide) {
    VertexRun run;
    run.setup_s = 10;
    run.channel[0] = {{4, 3, 2}, {1, 2, 3}, Status::stationary};
    run.channel[1] = {{4, 1}, {1, 5}, Status::stationary};
    EXPECT_EQ(run.channel[0].first_below(3.5), 1);
    EXPECT_EQ(run.channel[0].first_below(1.5), -1);
    EXPECT_EQ(run.time_at(0), 2);
    EXPECT_EQ(run.time_at(2), 8);  // a channel that ended stays at its last row
    EXPECT_EQ(run.time_at({2, 0, 0}), 4);
    run.joint = true;
    EXPECT_EQ(run.time_at(2), 5);
    const Trace trace = trace_of({&run, 1}, 2);
    ASSERT_EQ(trace.rows.size(), 3u);
    EXPECT_EQ(trace.rows[2].time_s, 7.5);
    EXPECT_EQ(trace.rows[2].error, 3);
    EXPECT_EQ(trace.rows[1].accepted, 2u);
    EXPECT_EQ(trace.rows[1].active, 1u);
}

}  // namespace
}  // namespace radiafit

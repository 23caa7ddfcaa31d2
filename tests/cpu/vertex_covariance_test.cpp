// Error bars of light field maps: of known matrices, against dense inverses in double, and against the scatter of many
// fits.
#include "cpu/vertex_covariance.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "cpu/lfm_engine.h"
#include "cpu/ring_samples.h"
#include "gauss.h"
#include "model/covariance.h"
#include "model/penalty.h"
#include "optim/optimizer.h"
#include "scenes.h"

namespace radiafit {
namespace {

using namespace testing;
using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;

MatrixXd random_matrix(Rng& rng, Index rows, Index columns) {
    MatrixXd out(rows, columns);
    for (Index i = 0; i < rows; ++i)
        for (Index j = 0; j < columns; ++j) out(i, j) = double(rng.uniform(-1, 1));
    return out;
}

/// As one matrix, and the arrow's part of one.
MatrixXd dense(const ArrowMatrix& arrow) {
    Index size = arrow.corner.rows(), at = 0;
    for (const MatrixXd& block : arrow.blocks) size += block.rows();
    MatrixXd out = MatrixXd::Zero(size, size);
    const Index corner = arrow.corner.rows(), begin = size - corner;
    for (size_t b = 0; b < arrow.blocks.size(); at += arrow.blocks[b++].rows()) {
        const Index rows = arrow.blocks[b].rows();
        out.block(at, at, rows, rows) = arrow.blocks[b];
        out.block(at, begin, rows, corner) = arrow.borders[b];
        out.block(begin, at, corner, rows) = arrow.borders[b].transpose();
    }
    out.bottomRightCorner(corner, corner) = arrow.corner;
    return out;
}
/// Entries of `of` within the arrow's shape; 0 elsewhere.
MatrixXd within_arrow(const MatrixXd& of, const ArrowMatrix& shape) {
    ArrowMatrix ones = shape;
    for (MatrixXd& block : ones.blocks) block.setOnes();
    for (MatrixXd& border : ones.borders) border.setOnes();
    ones.corner.setOnes();
    return of.cwiseProduct(dense(ones));
}
/// J^T J of random rows, each of one block's unknowns and the corner's.
ArrowMatrix random_arrow(Rng& rng, const std::vector<Index>& sizes, Index corner) {
    ArrowMatrix out(sizes, corner);
    for (size_t b = 0; b < sizes.size(); ++b) {
        const MatrixXd own = random_matrix(rng, 3 * sizes[b], sizes[b]),
                       view = random_matrix(rng, 3 * sizes[b], corner);
        out.blocks[b] = own.transpose() * own;
        out.borders[b] = own.transpose() * view;
        out.corner += view.transpose() * view;
    }
    return out;
}
/// Z (Z^T H Z)^-1 Z^T, Z the changes whose last part is orthogonal to what is held.
MatrixXd held_inverse(const MatrixXd& matrix, const MatrixXd& held) {
    if (held.cols() == 0) return matrix.inverse();
    MatrixXd fixed = MatrixXd::Zero(matrix.rows(), held.cols());
    fixed.bottomRows(held.rows()) = held;
    const Eigen::ColPivHouseholderQR<MatrixXd> basis(fixed);
    const MatrixXd free = MatrixXd(basis.householderQ()).rightCols(matrix.rows() - basis.rank());
    return free * (free.transpose() * matrix * free).inverse() * free.transpose();
}
/// What least_curvature adds is a 1e-9th of the diagonal: some of it shows, magnified by the conditions of these tests.
constexpr double rounding = 1e-5;
void expect_equal(const MatrixXd& a, const MatrixXd& b) {
    ASSERT_EQ(a.rows(), b.rows());
    const VectorXd unit = b.diagonal().cwiseAbs().cwiseSqrt().cwiseMax(1e-12);
    for (Index i = 0; i < a.rows(); ++i)
        for (Index j = 0; j < a.cols(); ++j)
            ASSERT_NEAR(a(i, j), b(i, j), rounding * unit[i] * unit[j]) << i << " " << j;
}

TEST(ArrowInverse, IsTheDenseInverseWithinTheArrow) {
    Rng rng(1);
    ArrowMatrix arrow = random_arrow(rng, {4, 6, 3}, 5), other = random_arrow(rng, {4, 6, 3}, 5);
    for (const Index held : {0, 2}) {
        const MatrixXd axes = random_matrix(rng, 5, held);
        const ArrowInverse inverse(arrow, axes);
        EXPECT_EQ(inverse.deficient(), 0);
        const MatrixXd expected = held_inverse(dense(arrow), axes);
        expect_equal(dense(inverse.inverse()), within_arrow(expected, arrow));
        expect_equal(dense(inverse.around(other)), within_arrow(expected * dense(other) * expected, arrow));
        EXPECT_NEAR(inverse.inverse().product_trace(other), (expected * dense(other)).trace(), 1e-5);
    }
}

TEST(ArrowInverse, CountsDirectionsWithoutCurvature) {
    Rng rng(2);
    ArrowMatrix arrow = random_arrow(rng, {4, 6}, 5);
    arrow.blocks[0].row(1).setZero(), arrow.blocks[0].col(1).setZero(), arrow.borders[0].row(1).setZero();
    arrow.corner.row(2).setZero(), arrow.corner.col(2).setZero();
    for (MatrixXd& border : arrow.borders) border.col(2).setZero();
    const ArrowInverse inverse(arrow, MatrixXd::Zero(5, 0));
    EXPECT_EQ(inverse.deficient(), 2);
    EXPECT_GT(inverse.inverse().blocks[0](1, 1), 1e8);
    EXPECT_GT(inverse.inverse().corner(2, 2), 1e8);
    EXPECT_LT(inverse.inverse().blocks[0](0, 0), 1e3);
    // one that is held does not count
    EXPECT_EQ(ArrowInverse(arrow, MatrixXd::Identity(5, 5).col(2)).deficient(), 1);
}

/// One vertex with a ring of seven, all of whose texels every image shows.
struct ErrorBarScene : SampledScene {
    static constexpr uint32_t hub = 9;  ///< of troubled_mesh(2, ...)
    uint32_t vertex;
    LfmLayout layout;
    std::vector<float> truth;  ///< of the vertex; zeros of the others

    explicit ErrorBarScene(const LfmOptions& o, int images = 40, float share = 1, uint32_t of = hub)
        : SampledScene(o, sheet_dataset(troubled_mesh(2, 7, 1), images, 8, 2),
                       [&](const TriangleAtlas& atlas, const Dataset&) {
                           return share < 1 ? random_samples(atlas, size_t(images), share, 3)
                                            : all_texels(atlas, uint32_t(images));
                       }),
          vertex(of),
          layout(rings, atlas, o.view_side, o.terms),
          truth(layout.size()) {
        Rng rng(4);
        const size_t terms = size_t(o.terms);
        size_t at = layout.offset(vertex);
        for (const Corner& corner : rings.ring(vertex))
            for (uint32_t local = 0; local < atlas.tile(corner.triangle).texels(); ++local)
                for (size_t k = 0; k < terms; ++k, at += 4)
                    for (size_t c = 0; c < 3; ++c)
                        truth[at + c] = atlas.tile(corner.triangle).barycentric(local)[corner.corner] *
                                        (k ? rng.uniform(-0.3f, 0.3f) : rng.uniform(0.3f, 0.6f));
        for (; at < layout.offset(vertex + 1); at += 4)
            for (size_t c = 0; c < 3; ++c)
                truth[at + c] = at / 4 % terms ? rng.uniform(-0.6f, 0.6f) : rng.uniform(0.6f, 1.2f);
    }
    static SampleList all_texels(const TriangleAtlas& atlas, uint32_t images) {
        SampleList list;
        for (uint32_t i = 0; i < images; ++i) list.views.push_back(i);
        list.tile_groups.push_back(0);
        for (uint32_t tile = 0; tile < atlas.tile_count(); ++tile) {
            for (uint32_t image = 0; image < images && !atlas.degenerate(tile); ++image) {
                list.groups.push_back({image, list.samples.size()});
                for (uint32_t local = 0; local < atlas.tile(tile).texels(); ++local)
                    list.samples.push_back({{0, 0, 0}, uint16_t(local)});
            }
            list.tile_groups.push_back(uint32_t(list.groups.size()));
        }
        list.groups.push_back({0, list.samples.size()});
        return list;
    }

    /// body(sample, its texel's index among the vertex's, Lambda, derivatives by h, [4m^2] by view texels' weights)
    template <class Body>
    void for_samples(SampleList& list, const Body& body) const {
        const auto frames = vertex_frames(dataset.mesh);
        size_t first = 0;
        for (const Corner& corner : rings.ring(vertex)) {
            const TriangleTile& tile = atlas.tile(corner.triangle);
            for (uint32_t g = list.tile_groups[corner.triangle]; g < list.tile_groups[corner.triangle + 1]; ++g) {
                const ViewFootprint f = view_footprint(frames[vertex], dataset.mesh.positions[vertex],
                                                       dataset.views[list.groups[g].image].camera.center(),
                                                       options.view_side, options.lookup);
                VectorXd weights = VectorXd::Zero(layout.view_texels());
                for (int q = 0; q < 4; ++q)
                    if (f.weight[q] > 0)
                        weights[f.texel + (q & 1) + (q & 2 ? options.view_side : 0)] += double(f.weight[q]);
                for (uint64_t s = list.groups[g].first; s < list.groups[g + 1].first; ++s)
                    body(list.samples[s], first + list.samples[s].local,
                         double(tile.barycentric(list.samples[s].local)[corner.corner]), weights);
            }
            first += tile.texels();
        }
    }
    size_t unknowns() const { return layout.block_size(vertex) / 4; }
    /// Of a channel, by parameters in the vertex's order.
    double value(const VectorXd& x, size_t texel, const VectorXd& view) const {
        const Index terms = options.terms, texels = Index(layout.surface_texels(vertex));
        double sum = 0;
        for (Index k = 0; k < terms; ++k) {
            double h = 0;
            for (Index j = 0; j < view.size(); ++j) h += view[j] * x[(texels + j) * terms + k];
            sum += x[Index(texel) * terms + k] * h;
        }
        return sum;
    }
    VectorXd channel(std::span<const float> p, size_t c) const {
        VectorXd out{Index(unknowns())};
        for (Index i = 0; i < out.size(); ++i) out[i] = double(p[layout.offset(vertex) + 4 * size_t(i) + c]);
        return out;
    }
    /// The view map, [view texels][terms].
    MatrixXd view_map(const VectorXd& x) const {
        MatrixXd out(layout.view_texels(), options.terms);
        for (Index j = 0; j < out.rows(); ++j)
            for (Index k = 0; k < out.cols(); ++k)
                out(j, k) = x[(Index(layout.surface_texels(vertex)) + j) * out.cols() + k];
        return out;
    }
    /// What the truth shows, and noise of a pixel.
    SampleList noisy(double noise, uint64_t seed) const {
        SampleList list = samples;
        Rng rng(seed);
        for (size_t c = 0; c < 3; ++c) {
            const VectorXd x = channel(truth, c);
            for_samples(list, [&](Sample& sample, size_t texel, double lambda, const VectorXd& view) {
                const double pixel = value(x, texel, view) / lambda + noise * gauss(rng);
                sample.rgb[c] = uint16_t(std::clamp(std::round(65535 * pixel), 0.0, 65535.0));
            });
        }
        return list;
    }
    struct Loaded {
        VertexProblem problem;
        std::vector<float> mean;
        std::vector<Lanes<float>> x;
    };
    Loaded load(const SampleList& list, std::span<const float> p) const {
        const auto statistics = count_rings(rings, list, TargetWeights<float>(atlas, list.scale));
        Loaded out{VertexProblem(dataset, atlas, rings, list.views, options), statistics.mean, {}};
        out.problem.load(vertex, list, &out.mean[3 * vertex]);
        out.x.resize(unknowns());
        set_lanes<float>(p.subspan(layout.offset(vertex), layout.block_size(vertex)), out.x.data());
        return out;
    }
};

LfmOptions small(int terms, float lambda) {
    LfmOptions o;
    o.terms = terms;
    o.surface_side = 2, o.view_side = 3;
    o.lambda_surface = lambda, o.lambda_view = lambda;
    o.lower = -100, o.upper = 100;
    return o;
}

/// The covariance by its definition, with matrices of all unknowns: derivatives and curvatures are differences.
MatrixXd dense_covariance(const ErrorBarScene& scene, SampleList list, const ErrorBarScene::Loaded& at, size_t c,
                          double& noise) {
    const VectorXd x = scene.channel(scene.truth, c);
    const Index n = x.size();
    MatrixXd normal = MatrixXd::Zero(n, n), noisy = normal, known(n, n);
    double squares = 0, lambdas = 0, samples = 0;
    scene.for_samples(list, [&](const Sample& sample, size_t texel, double lambda, const VectorXd& view) {
        VectorXd row(n);
        for (Index i = 0; i < n; ++i) {
            VectorXd more = x, less = x;
            more[i] += 0.5, less[i] -= 0.5;
            row[i] = scene.value(more, texel, view) - scene.value(less, texel, view);
        }
        const double residual = scene.value(x, texel, view) - lambda * double(list.scale) * sample.rgb[c];
        normal += row * row.transpose();
        noisy += lambda * lambda * row * row.transpose();
        squares += residual * residual, lambdas += lambda * lambda, samples += 1;
    });
    const auto penalty = [&](Index i, Index j) {
        std::vector<float> p(scene.layout.size());
        for (const Index k : {i, j})
            if (k >= 0) p[scene.layout.offset(scene.vertex) + 4 * size_t(k) + c] += 1;
        return penalty_error(scene.layout, scene.options, MapNeighbours::square(scene.options.view_side), scene.vertex,
                             p, {&at.mean[3 * scene.vertex], 3})[c];
    };
    const double density = samples / double(scene.layout.surface_texels(scene.vertex));
    for (Index i = 0; i < n; ++i)
        for (Index j = 0; j <= i; ++j)
            known(i, j) = known(j, i) = density * (penalty(i, j) - penalty(i, -1) - penalty(j, -1));
    const MatrixXd h = scene.view_map(x);
    const Index terms = h.cols();
    MatrixXd held = MatrixXd::Zero(h.size(), terms * terms);
    for (Index k = 0; k < terms; ++k)
        for (Index to = 0; to < terms; ++to)
            for (Index j = 0; j < h.rows(); ++j) held(j * terms + to, k * terms + to) = h(j, k);
    const MatrixXd inverse = held_inverse(normal + known, held);
    const double left = samples - (inverse * normal).trace();
    noise = std::sqrt(squares / left * samples / lambdas);
    return inverse * (noise * noise * noisy + squares / left * known) * inverse;
}

TEST(VertexErrorBars, AreTheDenseCovarianceWithinTheArrow) {
    for (const int terms : {1, 2}) {
        SCOPED_TRACE(terms);
        const ErrorBarScene scene(small(terms, 1e-2f), 12, 0.8f);
        const ErrorBarScene::Loaded at = scene.load(scene.samples, scene.truth);
        for (size_t c = 0; c < 3; ++c) {
            double noise = 0;
            const MatrixXd expected = dense_covariance(scene, scene.samples, at, c, noise);
            const ProblemErrorBars bars = problem_error_bars(at.problem, at.x, int(c));
            EXPECT_NEAR(bars.noise / noise, 1, rounding);
            EXPECT_EQ(bars.deficient, 0);
            expect_equal(dense(bars.covariance), within_arrow(expected, bars.covariance));
            ASSERT_EQ(bars.deviation.size(), size_t(expected.rows()));
            for (size_t i = 0; i < bars.deviation.size(); ++i)
                EXPECT_NEAR(double(bars.deviation[i]) / std::sqrt(expected(Index(i), Index(i))), 1, 1e-4) << i;
        }
    }
}

TEST(VertexErrorBars, OfAllVerticesAreThoseOfEach) {
    const ErrorBarScene scene(small(2, 1e-2f), 12, 0.8f);
    const AllVertexErrorBars all(scene.dataset, scene.atlas, scene.rings, scene.samples, scene.options, scene.truth,
                                 {});
    const ErrorBarScene::Loaded at = scene.load(scene.samples, scene.truth);
    const size_t unreferenced = scene.dataset.mesh.vertex_count() - 1;
    EXPECT_EQ(all.noise[3 * unreferenced], 0);
    for (size_t c = 0; c < 3; ++c) {
        const ProblemErrorBars bars = problem_error_bars(at.problem, at.x, int(c));
        EXPECT_EQ(all.noise[3 * scene.vertex + c], float(bars.noise));
        for (size_t i = 0; i < bars.deviation.size(); ++i)
            EXPECT_EQ(all.deviation[scene.layout.offset(scene.vertex) + 4 * i + c], bars.deviation[i]);
    }
}

/// Standard deviation of what a vertex adds to a texel's colour, [3].
VectorXd value_deviation(const ErrorBarScene& scene, uint32_t triangle, uint32_t local, const Vec3d& eye) {
    size_t texel = local;
    for (const Corner& corner : scene.rings.ring(scene.vertex)) {
        if (corner.triangle == triangle) break;
        texel += scene.atlas.tile(corner.triangle).texels();
    }
    const ViewFootprint f = view_footprint(vertex_frames(scene.dataset.mesh)[scene.vertex],
                                           scene.dataset.mesh.positions[scene.vertex], eye, 3, ViewLookup::bilinear);
    VectorXd view = VectorXd::Zero(9);
    for (int q = 0; q < 4; ++q) view[f.texel + (q & 1) + (q & 2 ? 3 : 0)] += double(f.weight[q]);
    const ErrorBarScene::Loaded at = scene.load(scene.samples, scene.truth);
    VectorXd out(3);
    for (size_t c = 0; c < 3; ++c) {
        double noise = 0;
        const MatrixXd covariance = dense_covariance(scene, scene.samples, at, c, noise);
        const VectorXd x = scene.channel(scene.truth, c);
        VectorXd row(x.size());
        for (Index i = 0; i < x.size(); ++i) {
            VectorXd more = x, less = x;
            more[i] += 0.5, less[i] -= 0.5;
            row[i] = scene.value(more, texel, view) - scene.value(less, texel, view);
        }
        out[Index(c)] = std::sqrt(row.dot(covariance * row));
    }
    return out;
}

TEST(VertexErrorBars, OfAColourAreTheSumOfItsVertices) {
    const ErrorBarScene hub(small(2, 1e-2f), 12, 0.8f);
    const uint32_t triangle = hub.rings.ring(ErrorBarScene::hub)[2].triangle, local = 1;
    const Vec3d eye = hub.dataset.views[3].camera.center();
    std::vector<float> parameters(hub.layout.size());
    VectorXd expected = VectorXd::Zero(3);
    for (const uint32_t vertex : hub.dataset.mesh.triangles[triangle]) {
        const ErrorBarScene scene(small(2, 1e-2f), 12, 0.8f, vertex);
        for (size_t i = 0; i < parameters.size(); ++i) parameters[i] += scene.truth[i];
        expected += value_deviation(scene, triangle, local, eye);
    }
    const std::vector<Vec3d> eyes = {hub.dataset.views[0].camera.center(), eye};
    const AllVertexErrorBars all(hub.dataset, hub.atlas, hub.rings, hub.samples, hub.options, parameters, eyes);
    for (Index c = 0; c < 3; ++c) EXPECT_NEAR(double(all.of_value(1, triangle, local)[c]) / expected[c], 1, 1e-3);
}

/// The fit in the gauge of the truth: h' = h M, g' = g M^-T, so that h' - h_0 is orthogonal to all h_0 X.
VectorXd aligned(const ErrorBarScene& scene, const VectorXd& x, const VectorXd& truth) {
    const MatrixXd h = scene.view_map(x), h0 = scene.view_map(truth);
    const MatrixXd mix = (h0.transpose() * h).inverse() * (h0.transpose() * h0);
    const MatrixXd back = mix.inverse().transpose();
    const Index terms = h.cols(), texels = Index(scene.layout.surface_texels(scene.vertex));
    VectorXd out = x;
    for (Index i = 0; i < texels + h.rows(); ++i)
        out.segment(i * terms, terms) = ((i < texels ? back : mix).transpose() * x.segment(i * terms, terms)).eval();
    return out;
}

TEST(VertexErrorBars, ScatterOfManyFitsIsAsFarAsTheySay) {
    constexpr int draws = 100;
    constexpr double noise = 0.01;
    for (const int terms : {1, 2}) {
        SCOPED_TRACE(terms);
        const ErrorBarScene scene(small(terms, 1e-7f));  // hardly anything but the samples counts
        VectorXd squares = VectorXd::Zero(Index(scene.unknowns())), predicted = squares;
        size_t within = 0, all = 0;
        for (int draw = 0; draw < draws; ++draw) {
            const SampleList list = scene.noisy(noise, uint64_t(100 + draw));
            std::vector<float> p = scene.truth;
            ErrorBarScene::Loaded at = scene.load(list, p);
            LaneEngine<VertexProblem> engine(at.problem);
            engine.count();
            optimize_terms(engine, {.rule = methods[0].modern, .iterations = 200}, terms, false,
                           {&p[scene.layout.offset(scene.vertex)], scene.layout.block_size(scene.vertex)});
            for (size_t c = 0; c < 3; ++c) {
                const VectorXd truth = scene.channel(scene.truth, c);
                const VectorXd fit = aligned(scene, scene.channel(p, c), truth);
                for (size_t i = 0; i < at.x.size(); ++i) at.x[i][int(c)] = float(fit[Index(i)]);
                const ProblemErrorBars bars = problem_error_bars(at.problem, at.x, int(c));
                EXPECT_NEAR(bars.noise, noise, 0.15 * noise);  // five standard deviations: few texels have most of it
                for (Index i = 0; i < fit.size(); ++i) {
                    const double off = fit[i] - truth[i], deviation = double(bars.deviation[size_t(i)]);
                    squares[i] += off * off, predicted[i] += deviation * deviation;
                    ++all, within += std::abs(off) <= deviation;
                }
            }
        }
        // 300 draws of a parameter tell its standard deviation to 4 %, the worst of some 60 is three times that off
        for (Index i = 0; i < squares.size(); ++i) EXPECT_NEAR(std::sqrt(squares[i] / predicted[i]), 1, 0.15) << i;
        EXPECT_NEAR(squares.cwiseQuotient(predicted).mean(), 1, 0.04);
        EXPECT_NEAR(double(within) / double(all), 0.6827, 0.02);
    }
}

TEST(VertexErrorBars, WhatNoSampleShowsIsNotTold) {
    // without smoothness, texels and view texels that no image shows are anything
    ErrorBarScene scene(small(1, 0), 12);
    const Corner unseen = scene.rings.ring(scene.vertex)[1];
    SampleList list = scene.noisy(0.01, 5);
    for (uint32_t g = list.tile_groups[unseen.triangle]; g < list.tile_groups[unseen.triangle + 1]; ++g)
        for (uint64_t s = list.groups[g].first; s < list.groups[g + 1].first; ++s) list.samples[s].local = 0;
    const ErrorBarScene::Loaded at = scene.load(list, scene.truth);
    const ProblemErrorBars bars = problem_error_bars(at.problem, at.x, 0);
    EXPECT_EQ(bars.deficient, 2);  // of a tile of three texels
    EXPECT_TRUE(std::isfinite(bars.deviation[3]));
    EXPECT_TRUE(std::isinf(bars.deviation[4]));
    EXPECT_TRUE(std::isinf(bars.deviation[5]));
    // with it, they follow their neighbours
    scene.options = small(1, 1e-2f);
    const ErrorBarScene::Loaded smooth = scene.load(list, scene.truth);
    const ProblemErrorBars follow = problem_error_bars(smooth.problem, smooth.x, 0);
    EXPECT_EQ(follow.deficient, 0);
    EXPECT_TRUE(std::isfinite(follow.deviation[4]));
    EXPECT_GT(follow.deviation[4], follow.deviation[3]);
}

}  // namespace
}  // namespace radiafit

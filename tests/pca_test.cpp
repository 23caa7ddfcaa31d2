// Factorization of the resampled light field: triangulation, resampling, singular values, and what comes out of them.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <Eigen/SVD>
#include <numbers>
#include <numeric>

#include "app/solve.h"
#include "base/parallel.h"
#include "dataset/synthetic/synthetic.h"
#include "fit_scene.h"
#include "geometry/raster.h"
#include "mesh_shapes.h"
#include "reference/pca_solver.h"
#include "reference/triangulation.h"
#include "reference/truncated_svd.h"

namespace radiafit {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

double cross(const Vec2d& a, const Vec2d& b, const Vec2d& c) {
    return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

/// Corners of the convex hull, counter-clockwise (Andrew's monotone chain).
std::vector<Vec2d> hull_of(std::vector<Vec2d> points) {
    std::sort(points.begin(), points.end(),
              [](const Vec2d& a, const Vec2d& b) { return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y(); });
    std::vector<Vec2d> hull;
    for (int side = 0; side < 2; ++side) {
        const size_t first = hull.size();
        for (const Vec2d& p : points) {
            while (hull.size() >= first + 2 && cross(hull[hull.size() - 2], hull.back(), p) <= 0) hull.pop_back();
            hull.push_back(p);
        }
        hull.pop_back();
        std::reverse(points.begin(), points.end());
    }
    return hull;
}

double distance_to(const Vec2d& a, const Vec2d& b, const Vec2d& p) {
    const double length = (b - a).squaredNorm();
    const double u = length > 0 ? std::clamp((b - a).dot(p - a) / length, 0.0, 1.0) : 0;
    return (a + u * (b - a) - p).norm();
}

std::vector<Vec2d> random_points(int count, Rng& rng) {
    std::vector<Vec2d> points;
    for (int i = 0; i < count; ++i) points.emplace_back(rng.uniform(), rng.uniform());
    return points;
}

std::vector<Vec2d> grid_points(int side) {
    std::vector<Vec2d> points;
    for (int i = 0; i < side * side; ++i) points.emplace_back(0.3 + 0.1 * (i % side), 0.1 * (i / side));
    return points;
}

std::vector<Vec2d> circle_points(int count) {
    std::vector<Vec2d> points;
    for (int i = 0; i < count; ++i) {
        const double angle = 2 * std::numbers::pi * i / count;
        points.emplace_back(0.5 + 0.5 * std::cos(angle), 0.5 + 0.5 * std::sin(angle));
    }
    return points;
}

/// Sets with triangles, regular and degenerate.
std::vector<std::vector<Vec2d>> planar_sets() {
    Rng rng(3);
    std::vector<std::vector<Vec2d>> sets = {grid_points(2), grid_points(7), circle_points(3), circle_points(40)};
    for (int count : {3, 4, 5, 10, 60, 300}) sets.push_back(random_points(count, rng));
    sets.push_back(random_points(30, rng));  // every point three times
    for (int i = 0; i < 60; ++i) sets.back().push_back(sets.back()[size_t(i)]);
    sets.push_back(random_points(20, rng));  // far away, tiny
    for (Vec2d& p : sets.back()) p = Vec2d(100, -7) + 1e-4 * p;
    sets.push_back(random_points(50, rng));  // almost on one line
    for (Vec2d& p : sets.back()) p.y() = 2 * p.x() + 1e-4 * p.y();
    return sets;
}

TEST(Triangulation, IsDelaunayAndFillsTheHull) {
    for (const std::vector<Vec2d>& points : planar_sets()) {
        SCOPED_TRACE(points.size());
        const Triangulation triangulation(points);
        Vec2d low = points[0], high = points[0];
        for (const Vec2d& p : points) low = low.cwiseMin(p), high = high.cwiseMax(p);
        const double extent = (high - low).maxCoeff();
        double area = 0;
        std::vector<bool> used(points.size());
        for (const auto& t : triangulation.triangles()) {
            const Vec2d &a = points[t[0]], &b = points[t[1]], &c = points[t[2]];
            for (uint32_t i : t) used[i] = true;
            EXPECT_GT(cross(a, b, c), 0);
            area += cross(a, b, c) / 2;
            // a point d is inside the circumcircle where the lifted determinant is positive
            for (const Vec2d& d : points) {
                Eigen::Matrix3d lifted;
                for (int i = 0; i < 3; ++i) {
                    const Vec2d e = (points[t[size_t(i)]] - d) / extent;
                    lifted.row(i) << e.x(), e.y(), e.squaredNorm();
                }
                ASSERT_LT(lifted.determinant(), 1e-12);
            }
        }
        const std::vector<Vec2d> hull = hull_of(points);
        double hull_area = 0, perimeter = 0, border = 0;
        for (size_t i = 0; i < hull.size(); ++i) {
            hull_area += cross(hull[0], hull[i], hull[(i + 1) % hull.size()]) / 2;
            perimeter += (hull[(i + 1) % hull.size()] - hull[i]).norm();
        }
        for (const auto& s : triangulation.border()) border += (points[s[1]] - points[s[0]]).norm();
        EXPECT_NEAR(area, hull_area, 1e-9 * extent * extent);
        EXPECT_NEAR(border, perimeter, 1e-9 * extent);
        for (size_t i = 0; i < points.size(); ++i) {
            const auto twin = size_t(std::find(points.begin(), points.end(), points[i]) - points.begin());
            EXPECT_EQ(used[i], twin == i) << "each place once, by its first point";
        }
    }
}

TEST(Triangulation, ReproducesLinearFunctionsInsideAndTheNearestHullPointOutside) {
    Rng rng(5);
    for (const std::vector<Vec2d>& points : planar_sets()) {
        SCOPED_TRACE(points.size());
        const Triangulation triangulation(points);
        Vec2d low = points[0], high = points[0];
        for (const Vec2d& p : points) low = low.cwiseMin(p), high = high.cwiseMax(p);
        const double extent = (high - low).maxCoeff();
        const std::vector<Vec2d> hull = hull_of(points);
        for (int i = 0; i < 300; ++i) {
            const Vec2d place = low - 0.2 * (high - low) +
                                1.4 * (high - low).cwiseProduct(Vec2d(double(rng.uniform()), double(rng.uniform())));
            const Triangulation::Weights w = triangulation.at(place);
            Vec2d at = Vec2d::Zero();
            for (size_t k = 0; k < 3; ++k) {
                EXPECT_GE(w.weight[k], 0);
                at += w.weight[k] * points[w.point[k]];
            }
            EXPECT_NEAR(w.weight[0] + w.weight[1] + w.weight[2], 1, 1e-12);
            double margin = 1e300, nearest = 1e300;  // signed distance inside; distance to the hull's border
            for (size_t k = 0; k < hull.size(); ++k) {
                const Vec2d &a = hull[k], &b = hull[(k + 1) % hull.size()];
                margin = std::min(margin, cross(a, b, place) / (b - a).norm());
                nearest = std::min(nearest, distance_to(a, b, place));
            }
            if (std::abs(margin) < 1e-9 * extent) continue;
            EXPECT_EQ(w.inside, margin > 0);
            EXPECT_NEAR((at - place).norm(), margin > 0 ? 0 : nearest, 1e-9 * extent);
        }
    }
}

TEST(Triangulation, PointsOnOneLineAndFewerThanThree) {
    Rng rng(7);
    std::vector<std::vector<Vec2d>> sets = {{{0.3, 0.4}}, {{0.3, 0.4}, {0.3, 0.4}}, {{0, 0}, {1, 2}}, {{5, 5}, {5, 6}}};
    for (const Vec2d& along : {Vec2d(1, 0), Vec2d(0, 1), Vec2d(0.3, -0.7)}) {
        sets.emplace_back();
        for (int i = 0; i < 12; ++i) sets.back().push_back(Vec2d(0.1, 0.2) + double(rng.index(9)) * along);
    }
    for (const std::vector<Vec2d>& points : sets) {
        const Triangulation triangulation(points);
        EXPECT_TRUE(triangulation.triangles().empty());
        for (int i = 0; i < 50; ++i) {
            const Vec2d place(double(rng.uniform(-3, 8)), double(rng.uniform(-8, 8)));
            const Triangulation::Weights w = triangulation.at(place);
            EXPECT_FALSE(w.inside);
            Vec2d at = Vec2d::Zero();
            for (size_t k = 0; k < 3; ++k) at += w.weight[k] * points[w.point[k]];
            double nearest = 1e300;
            for (const Vec2d& a : points)
                for (const Vec2d& b : points) nearest = std::min(nearest, distance_to(a, b, place));
            EXPECT_NEAR((at - place).norm(), nearest, 1e-9);
        }
    }
    EXPECT_THROW(Triangulation({}), std::invalid_argument);
    const std::vector<Vec2d> bad = {{0, 0}, {1, std::nan("")}};
    EXPECT_THROW(Triangulation{bad}, std::invalid_argument);
}

MatrixXd random_matrix(int rows, int columns, Rng& rng) {
    MatrixXd a(rows, columns);
    for (Index i = 0; i < a.size(); ++i) a.data()[i] = double(rng.uniform(-1, 1));
    return a;
}

TEST(TruncatedSvd, AgreesWithTheFullDecomposition) {
    Rng rng(11);
    std::vector<MatrixXd> matrices = {random_matrix(40, 12, rng), random_matrix(9, 30, rng), random_matrix(1, 5, rng),
                                      random_matrix(5, 1, rng), MatrixXd::Zero(6, 4)};
    matrices.push_back(random_matrix(20, 2, rng) * random_matrix(2, 15, rng));  // rank 2
    matrices.push_back(matrices.back().transpose());
    matrices.push_back(MatrixXd::Constant(20, 15, -0.3));
    for (const MatrixXd& a : matrices)
        for (int terms : {1, 2, 3, 6}) {
            SCOPED_TRACE(std::to_string(a.rows()) + " x " + std::to_string(a.cols()) + ", " + std::to_string(terms));
            const Eigen::JacobiSVD<MatrixXd> full(a, Eigen::ComputeThinU | Eigen::ComputeThinV);
            const Index kept = std::min<Index>(terms, full.singularValues().size());
            const MatrixXd best = full.matrixU().leftCols(kept) * full.singularValues().head(kept).asDiagonal() *
                                  full.matrixV().leftCols(kept).transpose();
            const TruncatedSvd svd = truncated_svd(a, terms);
            ASSERT_EQ(svd.g.cols(), terms);
            ASSERT_EQ(svd.h.cols(), terms);
            EXPECT_LT((svd.g * svd.h.transpose() - best).norm(), 1e-8 * std::max(1.0, a.norm()));
            for (Index k = 0; k < terms; ++k) {
                if (k >= kept || full.singularValues()[k] < 1e-7 * full.singularValues()[0] || a.norm() == 0) {
                    EXPECT_EQ(svd.g.col(k).norm() + svd.h.col(k).norm(), 0);
                    continue;
                }
                EXPECT_NEAR(svd.h.col(k).squaredNorm(), double(a.cols()), 1e-9 * double(a.cols()));
                EXPECT_GE(svd.h.col(k).sum(), 0);
            }
        }
}

TEST(TruncatedSvd, RefinementApproachesItFromAnywhere) {
    Rng rng(13);
    for (const auto& [rows, columns] : {std::pair{50, 20}, {12, 30}}) {
        const MatrixXd a = random_matrix(rows, columns, rng);
        const double least = (a -
                              [&] {
                                  const TruncatedSvd best = truncated_svd(a, 3);
                                  return MatrixXd(best.g * best.h.transpose());
                              }())
                                 .norm();
        TruncatedSvd svd{MatrixXd::Zero(rows, 3), random_matrix(columns, 3, rng)};
        double before = a.norm();
        for (int i = 0; i < 300; ++i) {
            refine(a, svd);
            const double now = (a - svd.g * svd.h.transpose()).norm();
            ASSERT_LE(now, before * (1 + 1e-12));
            before = now;
        }
        EXPECT_NEAR(before, least, 1e-6 * least);
    }
    const MatrixXd one = MatrixXd::Constant(9, 7, 0.4);  // lacks the rank for three terms
    TruncatedSvd of_one = truncated_svd(one, 3);
    refine(one, of_one);
    EXPECT_LT((of_one.g * of_one.h.transpose() - one).norm(), 1e-12);
    EXPECT_EQ(of_one.h.rightCols(2).norm(), 0);
    TruncatedSvd none{MatrixXd::Zero(4, 2), MatrixXd::Zero(3, 2)};
    refine(MatrixXd::Zero(4, 3), none);
    EXPECT_EQ(none.g.norm() + none.h.norm(), 0);
}

TEST(Resampling, ReachesExactlyTheViewTexelsThatALookUpCan) {
    for (int m : {2, 3, 8, 16}) {
        std::vector<bool> met(size_t(m * m));
        for (int i = 0; i < 400; ++i)
            for (int j = 0; j < 400; ++j) {
                const std::array<double, 2> at = {(i + 0.5) / 400, (j + 0.5) / 400};
                if (std::hypot(at[0] - 0.5, at[1] - 0.5) > 0.5) continue;
                const ViewFootprint f = view_footprint(at, m, ViewLookup::bilinear);
                const int corner[4] = {f.texel, f.texel + 1, f.texel + m, f.texel + m + 1};
                for (int k = 0; k < 4; ++k)
                    if (f.weight[k] > 0) met[size_t(corner[k])] = true;
            }
        std::vector<uint32_t> expected;
        for (uint32_t i = 0; i < met.size(); ++i)
            if (met[i]) expected.push_back(i);
        EXPECT_EQ(reachable_view_texels(m), expected) << m;
    }
}

/// A closed fan around vertex 0 and what images of it hold, without images.
struct Fan {
    static constexpr int surface_side = 5, view_side = 8;
    Dataset dataset;
    TriangleAtlas atlas;
    VertexRings rings;
    TileViews tiles;
    Frame frame;

    /// value(tile, local, view coordinate of vertex 0, channel) in [0, 1]; sees(tile, local, image).
    template <class Value, class Sees>
    Fan(int views, const Value& value, const Sees& sees)
        : dataset(testing::sheet_dataset(mesh(), views, 64, 9)),
          atlas(dataset.mesh, surface_side),
          rings(dataset.mesh) {
        frame = vertex_frames(dataset.mesh)[0];
        tiles.texels_per_tile = atlas.texels_per_tile();
        tiles.tile_first.push_back(0);
        for (uint32_t i = 0; i < dataset.views.size(); ++i) tiles.views.push_back(i);
        for (uint32_t tile = 0; tile < atlas.tile_count(); ++tile) {
            for (uint32_t image = 0; image < dataset.views.size(); ++image) {
                std::vector<TileViews::Texel> texels(tiles.texels_per_tile);
                bool any = false;
                for (uint32_t local = 0; local < texels.size(); ++local) {
                    if (!sees(tile, local, image)) continue;
                    any = true;
                    texels[local].seen = 1;
                    for (int c = 0; c < 3; ++c)
                        texels[local].rgb[c] = uint16_t(std::lround(65535 * value(tile, local, direction(image), c)));
                }
                if (!any) continue;
                tiles.images.push_back(image);
                tiles.texels.insert(tiles.texels.end(), texels.begin(), texels.end());
            }
            tiles.tile_first.push_back(uint32_t(tiles.images.size()));
        }
    }
    static Mesh mesh() {
        Rng rng(2);
        return testing::fan(6, true, rng);
    }
    Vec2d direction(uint32_t image) const {
        return Vec2d(view_coordinate(frame, dataset.mesh.positions[0], dataset.views[image].camera.center()).data());
    }
    RingResampler resampler() const { return {dataset, atlas, rings, tiles, view_side}; }
    DenseLightField resample(size_t vertex = 0) const {
        DenseLightField field;
        resampler().resample(vertex, field);
        return field;
    }
    PcaFit fit(int terms, int refills = 0) const { return pca_solver(resampler(), layout(terms), refills); }
    LfmLayout layout(int terms) const { return {rings, int(atlas.texels_per_tile()), view_side, terms}; }
    Vec2d center(size_t column) const {
        const uint32_t texel = reachable_view_texels(view_side)[column];
        return {(texel % view_side + 0.5) / view_side, (texel / view_side + 0.5) / view_side};
    }
    double weight(size_t row) const {  ///< L of vertex 0
        const Corner& corner = rings.ring(0)[row / tiles.texels_per_tile];
        return double(atlas.barycentric(uint32_t(row % tiles.texels_per_tile))[corner.corner]);
    }
    uint32_t tile(size_t row) const { return rings.ring(0)[row / tiles.texels_per_tile].triangle; }
    uint32_t local(size_t row) const { return uint32_t(row % tiles.texels_per_tile); }
    /// sum_k g_k h_k of vertex 0 at a row and a column.
    double product(const std::vector<float>& p, int terms, size_t row, size_t column, int c) const {
        const LfmLayout l = layout(terms);
        const float* g = p.data() + l.offset(0) + row * l.stride() + c;
        const float* h = p.data() + l.view_offset(0) + reachable_view_texels(view_side)[column] * l.stride() + c;
        double sum = 0;
        for (int k = 0; k < terms; ++k) sum += double(g[4 * k]) * double(h[4 * k]);
        return sum;
    }
};

constexpr auto all_seen = [](uint32_t, uint32_t, uint32_t) { return true; };
// Two terms, each linear in the view coordinate.
double two_terms(uint32_t tile, uint32_t local, const Vec2d& at, int c) {
    return (0.2 + 0.01 * local) * (0.3 + 0.4 * at.x() + 0.1 * c) +
           (0.1 + 0.05 * ((tile + local) % 5)) * (0.5 - 0.3 * at.x() + 0.3 * at.y());
}

TEST(Pca, RecoversALightFieldThatIsLinearInTheViewCoordinate) {
    const Fan fan(30, two_terms, all_seen);
    const DenseLightField field = fan.resample();
    const std::vector<float> p = fan.fit(2).parameters, one = fan.fit(1).parameters;
    double worst = 0, worst_of_one = 0;
    size_t known = 0;
    for (size_t row = 0; row < size_t(field.invented.rows()); ++row)
        for (size_t column = 0; column < size_t(field.invented.cols()); ++column) {
            if (field.invented(Index(row), Index(column)) > 0) continue;
            ++known;
            for (int c = 0; c < 3; ++c) {
                const double expected =
                    fan.weight(row) * two_terms(fan.tile(row), fan.local(row), fan.center(column), c);
                EXPECT_NEAR(field.channel[c](Index(row), Index(column)), expected, 1.0 / 65535);
                worst = std::max(worst, std::abs(fan.product(p, 2, row, column, c) - expected));
                worst_of_one = std::max(worst_of_one, std::abs(fan.product(one, 1, row, column, c) - expected));
            }
        }
    EXPECT_GT(known, size_t(field.invented.size() / 10));
    EXPECT_LT(worst, 2.0 / 65535);  // what is stored is rounded to 16 bits
    EXPECT_GT(worst_of_one, 1e-2);
}

TEST(Pca, CountsWhatItInvents) {
    // tile 0: nowhere seen; tile 1: half of its texels; tile 2: by two images, so from no area of directions
    const auto sees = [](uint32_t tile, uint32_t local, uint32_t image) {
        if (tile == 0) return false;
        if (tile == 1) return local < 7;
        return tile != 2 || image < 2;
    };
    const Fan fan(12, two_terms, sees);
    const DenseLightField field = fan.resample();
    std::vector<Vec2d> directions;
    for (uint32_t i = 0; i < 12; ++i) directions.push_back(fan.direction(i));
    const std::vector<Vec2d> hull = hull_of(directions);
    const size_t columns = reachable_view_texels(Fan::view_side).size(), texels = fan.tiles.texels_per_tile;
    uint64_t outside = 0, unseen = 0;
    for (size_t row = 0; row < size_t(field.invented.rows()); ++row) {
        const uint32_t tile = fan.tile(row);
        const bool seen = sees(tile, fan.local(row), 0);
        EXPECT_EQ(field.seen[row] != 0, seen);
        for (size_t column = 0; column < columns; ++column) {
            bool inside = tile != 2;
            for (size_t k = 0; k < hull.size(); ++k)
                inside = inside && cross(hull[k], hull[(k + 1) % hull.size()], fan.center(column)) >= 0;
            outside += seen && !inside;
            unseen += !seen;
            EXPECT_EQ(field.invented(Index(row), Index(column)) > 0, !seen || !inside);
            for (int c = 0; c < 3; ++c) {  // made of what is seen: within its range
                EXPECT_GE(field.channel[c](Index(row), Index(column)), 0.05 * fan.weight(row));
                EXPECT_LE(field.channel[c](Index(row), Index(column)), fan.weight(row));
            }
        }
    }
    EXPECT_EQ(field.counts.entries, 6 * texels * columns);
    EXPECT_EQ(field.counts.outside_hull, outside);
    EXPECT_EQ(field.counts.unseen_texels, unseen);
    EXPECT_EQ(unseen, (texels + texels - 7) * columns);
    const ResamplingCounts all = fan.fit(1).resampling;  // every tile has three vertices
    EXPECT_EQ(all.entries, 3 * field.counts.entries);
    EXPECT_EQ(all.unseen_texels, 3 * unseen);
}

TEST(Pca, OneImageOnly) {
    const Fan fan(
        1, [](uint32_t tile, uint32_t local, const Vec2d&, int) { return 0.1 + 0.02 * tile + 0.01 * local; }, all_seen);
    const DenseLightField field = fan.resample();
    EXPECT_EQ(field.counts.outside_hull, field.counts.entries);
    EXPECT_EQ(field.counts.invented_share(), 1);
    const std::vector<float> p = fan.fit(3, 2).parameters;
    for (size_t row = 0; row < field.seen.size(); ++row)
        for (size_t column : {size_t(0), size_t(20)})
            EXPECT_NEAR(fan.product(p, 3, row, column, 1),
                        fan.weight(row) * (0.1 + 0.02 * fan.tile(row) + 0.01 * fan.local(row)), 1e-5);
}

TEST(Pca, AVertexThatNoImageSeesKeepsZeros) {
    const Fan dark(5, two_terms, [](uint32_t, uint32_t, uint32_t) { return false; });
    const PcaFit none = dark.fit(2, 1);
    EXPECT_EQ(none.parameters, std::vector<float>(dark.layout(2).size()));
    EXPECT_EQ(none.resampling.entries, 0u);
    EXPECT_EQ(none.resampling.invented_share(), 0);

    // Tile 0 alone is seen: of the rim, only its two vertices.
    const Fan fan(5, two_terms, [](uint32_t tile, uint32_t, uint32_t) { return tile == 0; });
    const PcaFit fit = fan.fit(1);
    const LfmLayout layout = fan.layout(1);
    for (uint32_t v = 0; v < layout.problem_count(); ++v) {
        const auto& corners = fan.dataset.mesh.triangles[0];
        const bool seen = std::find(corners.begin(), corners.end(), v) != corners.end();
        const auto first = fit.parameters.begin() + long(layout.offset(v));
        EXPECT_EQ(std::any_of(first, first + long(layout.block_size(v)), [](float x) { return x != 0; }), seen) << v;
    }
}

// Directions differ from tile to tile, so what one tile lacks the others show.
TEST(Pca, RefillsLowerTheErrorOfWhatIsKnown) {
    const auto value = [](uint32_t tile, uint32_t local, const Vec2d& at, int) {
        return (0.3 + 0.02 * local + 0.03 * tile) * (0.2 + at.x() + 0.5 * at.y());
    };
    const Fan fan(40, value, [](uint32_t tile, uint32_t, uint32_t image) { return (image + tile) % 5 < 2; });
    const DenseLightField field = fan.resample();
    const auto error = [&](int refills) {
        const std::vector<float> p = fan.fit(1, refills).parameters;
        double sum = 0;
        for (size_t row = 0; row < field.seen.size(); ++row)
            for (size_t column = 0; column < size_t(field.invented.cols()); ++column)
                if (field.invented(Index(row), Index(column)) == 0)
                    sum += std::pow(fan.product(p, 1, row, column, 0) - field.channel[0](Index(row), Index(column)), 2);
        return sum;
    };
    const double none = error(0), few = error(5), many = error(300);
    EXPECT_LT(few, 0.7 * none);
    EXPECT_LT(many, 1e-3 * none) << "one term holds all that is known";
}

TEST(Pca, TexelsLookUpTheirPixels) {
    // A wall with a plate before it; values are linear in the pixel's place, so bilinear look-ups are exact.
    Mesh mesh;
    mesh.positions = {{-3, -3, 0}, {3, -3, 0}, {3, 3, 0}, {-3, 3, 0}, {0, 0, 1}, {0.5, 0, 1}, {0, 0.5, 1}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}};
    Dataset header;
    header.mesh = mesh;
    for (double x : {-1.0, 0.5}) {
        View view;
        view.name = "view";
        view.camera = Camera::look_at({x, 0.3, 4}, {0, 0, 0}, {0, 1, 0}, 0.7, 64, 64);
        header.views.push_back(view);
    }
    const auto pixel = [](size_t view, int x, int y, int c) { return uint8_t(10 + 2 * x + y + int(view) * c); };
    for (bool masks : {false, true}) {
        const testing::TemporaryFolder folder;
        const Dataset dataset = testing::write_dataset(folder.path() / "data", header, pixel, masks);
        const TriangleAtlas atlas(dataset.mesh, 16);
        TileViews results[2];
        for (int threads : {1, 2}) {
            set_thread_count(threads);
            results[threads - 1] = resample_tiles(dataset, atlas, {0, 1}, TargetSpace::stored);
        }
        set_thread_count(0);
        const TileViews& tiles = results[0];
        EXPECT_EQ(tiles.images, results[1].images);
        ASSERT_EQ(tiles.texels.size(), results[1].texels.size());
        for (size_t i = 0; i < tiles.texels.size(); ++i) {
            EXPECT_EQ(tiles.texels[i].seen, results[1].texels[i].seen);
            for (int c = 0; c < 3; ++c) EXPECT_EQ(tiles.texels[i].rgb[c], results[1].texels[i].rgb[c]);
        }
        size_t exact = 0, hidden = 0, masked = 0;
        for (uint32_t tile = 0; tile < 3; ++tile)
            for (size_t i = 0; i < tiles.images_of(tile).size(); ++i) {
                const uint32_t view = tiles.images_of(tile)[i];
                Rasterizer raster;
                raster.draw(dataset.mesh, dataset.views[view].camera);
                for (uint32_t local = 0; local < tiles.texels_per_tile; ++local) {
                    const Vec2d at =
                        dataset.views[view].camera.project(atlas.position(tile, local).cast<double>()).head<2>();
                    const TileViews::Texel& texel = tiles.of(tile, i)[local];
                    if (!(at.minCoeff() >= 0 && at.maxCoeff() < 64)) {
                        EXPECT_FALSE(texel.seen);
                        continue;
                    }
                    // the plate stands alone: no vertex of the wall's
                    const auto in_front = [&](int x, int y) {
                        if (x < 0 || y < 0 || x > 63 || y > 63) return false;
                        const uint32_t there = raster.pixels()[size_t(y * 64 + x)].triangle;
                        return there != no_triangle && (there == 2) == (tile == 2);
                    };
                    const auto shows = [&](int x, int y) {
                        return in_front(x, y) && (!masks || (x / 5 + y / 7) % 4 != 0);
                    };
                    const int x = int(at.x()), y = int(at.y());
                    EXPECT_EQ(texel.seen != 0, shows(x, y));
                    hidden += tile < 2 && raster.pixels()[size_t(y * 64 + x)].triangle == 2;
                    masked += in_front(x, y) && !texel.seen;
                    const int x0 = int(std::floor(at.x() - 0.5)), y0 = int(std::floor(at.y() - 0.5));
                    if (!texel.seen || !shows(x0, y0) || !shows(x0 + 1, y0) || !shows(x0, y0 + 1) ||
                        !shows(x0 + 1, y0 + 1))
                        continue;
                    ++exact;
                    for (int c = 0; c < 3; ++c)
                        ASSERT_NEAR(texel.rgb[c], 257 * (10 + 2 * (at.x() - 0.5) + (at.y() - 0.5) + double(view) * c),
                                    0.51);
                }
            }
        EXPECT_GT(exact, 100u);
        EXPECT_GT(hidden, 0u);
        EXPECT_EQ(masked > 0, masks);
    }
}

TEST(Pca, BetweenTheMeanAndTheNonlinearOptimum) {
    const testing::TemporaryFolder folder;
    generate_synthetic({.shape = "star", .scale = "smoke"}, folder.path() / "star");
    const Dataset dataset = open_dataset(folder.path() / "star");
    FitRequest request;
    request.iterations = 100;  // the smoothness that it pays for as well leaves it far below
    const auto fitted = [&](const char* solver, int terms) {
        request.solver = solver;
        request.model.terms = terms;
        return solve(dataset, request);
    };
    const auto error = [](const FitOutcome& out) {
        return std::accumulate(out.fit.error.begin(), out.fit.error.end(), 0.0);
    };
    const double mean = error(fitted("mean", 1));
    for (int terms : {1, 3}) {
        const double pca = error(fitted("pca", terms)), nonlinear = error(fitted("stream", terms));
        EXPECT_LT(pca, mean);
        EXPECT_GE(pca, nonlinear);
    }

    FitOutcome runs[2];
    for (int threads : {1, 2}) {
        set_thread_count(threads);
        request.refills = 2;
        runs[threads - 1] = fitted("pca", 2);
    }
    set_thread_count(0);
    EXPECT_EQ(runs[0].fit.parameters, runs[1].fit.parameters);
    const ResamplingCounts& counts = runs[0].resampling;
    EXPECT_GT(counts.outside_hull, 0u);
    EXPECT_LT(counts.invented_share(), 1);
    EXPECT_EQ(runs[1].resampling.outside_hull, counts.outside_hull);
    EXPECT_EQ(runs[1].resampling.entries, counts.entries);
}

}  // namespace
}  // namespace radiafit

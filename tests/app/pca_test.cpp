// Factorization of the resampled light field: resampling, and what comes out of it.
#include <gtest/gtest.h>

#include <numeric>

#include "base/parallel.h"
#include "convex_hull.h"
#include "fit_scene.h"
#include "fitting/solvers/solve.h"
#include "geometry/raster.h"
#include "mesh_shapes.h"
#include "reference/pca_solver.h"
#include "synthetic/synthetic.h"

namespace radiafit {
using namespace fits;
namespace {

using Eigen::Index;
using testing::cross;
using testing::hull_of;

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
    Fan(int views, const Value& value, const Sees& sees, bool own_sides = false)
        : dataset(testing::sheet_dataset(mesh(), views, 64, 9)),
          atlas(surface_atlas(dataset.mesh, own_sides ? testing::with_own_sides(model(), dataset.mesh) : model())),
          rings(dataset.mesh) {
        frame = vertex_frames(dataset.mesh)[0];
        tiles.tile_first.push_back(0);
        tiles.texel_first.push_back(0);
        for (uint32_t i = 0; i < dataset.views.size(); ++i) tiles.views.push_back(i);
        for (uint32_t tile = 0; tile < atlas.tile_count(); ++tile) {
            for (uint32_t image = 0; image < dataset.views.size(); ++image) {
                std::vector<TileViews::Texel> texels(atlas.tile(tile).texels());
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
            tiles.texel_first.push_back(tiles.texels.size());
        }
    }
    static LfmOptions model() { return {.surface_side = surface_side}; }
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
    PcaFit fit(int terms, int refills = 0) const { return fits(terms, {{refills}}).front(); }
    std::vector<PcaFit> fits(int terms, std::span<const int> refills) const {
        return pca_solver(resampler(), layout(terms), refills);
    }
    LfmLayout layout(int terms) const { return {rings, atlas, view_side, terms}; }
    Vec2d center(size_t column) const {
        const uint32_t texel = reachable_view_texels(view_side)[column];
        return {(texel % view_side + 0.5) / view_side, (texel / view_side + 0.5) / view_side};
    }
    /// Which corner of vertex 0's ring, and which texel of its tile, a row is.
    std::pair<Corner, uint32_t> place(size_t row) const {
        for (const Corner& corner : rings.ring(0)) {
            const uint32_t texels = atlas.tile(corner.triangle).texels();
            if (row < texels) return {corner, uint32_t(row)};
            row -= texels;
        }
        throw std::out_of_range("row");
    }
    double weight(size_t row) const {  ///< L of vertex 0
        const auto [corner, local] = place(row);
        return double(atlas.tile(corner.triangle).barycentric(local)[corner.corner]);
    }
    uint32_t tile(size_t row) const { return place(row).first.triangle; }
    uint32_t local(size_t row) const { return place(row).second; }
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

class PcaOfSides : public ::testing::TestWithParam<bool> {};  // each its own
TEST_P(PcaOfSides, RecoversALightFieldThatIsLinearInTheViewCoordinate) {
    const Fan fan(30, two_terms, all_seen, GetParam());
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

INSTANTIATE_TEST_SUITE_P(Own, PcaOfSides, ::testing::Bool());

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
    const size_t columns = reachable_view_texels(Fan::view_side).size(), texels = fan.atlas.texels_per_tile();
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

TEST(Pca, SeveralRefillsFromOneResamplingAreThoseOfSingleFits) {
    const auto value = [](uint32_t tile, uint32_t local, const Vec2d& at, int) {
        return (0.3 + 0.02 * local + 0.03 * tile) * (0.2 + at.x() * at.y());
    };
    const Fan fan(40, value, [](uint32_t tile, uint32_t, uint32_t image) { return (image + tile) % 5 < 2; });
    const std::vector<PcaFit> several = fan.fits(2, {{0, 2, 2, 5}});
    ASSERT_EQ(several.size(), 4U);
    for (const auto& [place, refills] : {std::pair{0U, 0}, {1U, 2}, {2U, 2}, {3U, 5}})
        EXPECT_EQ(several[place].parameters, fan.fit(2, refills).parameters) << refills;
    EXPECT_NE(several[1].parameters, several[3].parameters);
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
        const TemporaryFolder folder;
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
                for (uint32_t local = 0; local < atlas.texels_per_tile(); ++local) {
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
    const TemporaryFolder folder;
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

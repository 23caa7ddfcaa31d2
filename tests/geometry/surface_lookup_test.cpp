#include "geometry/surface_lookup.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/rng.h"
#include "mesh_shapes.h"

namespace radiafit {
namespace {

using testing::ball;

struct Surface {
    Mesh mesh = ball(3, 0.2f);
    TriangleAtlas atlas;
    TexelLookup nearest, linear;
    explicit Surface(bool own_sides)
        : atlas(mesh, 13, own_sides ? random_sides() : nullptr),
          nearest(atlas, SurfaceLookup::nearest),
          linear(atlas, SurfaceLookup::linear) {}
    TileSides random_sides() const {
        Rng rng(3);
        std::vector<uint8_t> sides;
        for (size_t t = 0; t < mesh.triangle_count(); ++t) sides.push_back(uint8_t(2 + rng.index(12)));
        return std::make_shared<const std::vector<uint8_t>>(sides);
    }
};

struct Point {
    float b1, b2;
};
Point random_point(Rng& rng) {
    const float b1 = rng.uniform(), b2 = rng.uniform();
    return b1 + b2 > 1 ? Point{1 - b1, 1 - b2} : Point{b1, b2};
}

/// What a look-up shows where texels hold random numbers from 0 to 1.
float shown(const TexelLookup& lookup, uint32_t triangle, float b1, float b2) {
    float sum = 0;
    const TexelMix mix = lookup.at(triangle, b1, b2);
    for (const auto& [t, local, weight] : mix.entries()) sum += weight * float(random_bits(t, local) % 1000) / 1000.0f;
    return sum;
}

class SurfaceLookups : public ::testing::TestWithParam<bool> {
protected:
    const Surface surface{GetParam()};
};

TEST_P(SurfaceLookups, WeightsArePositiveAndTheirSumIsOne) {
    Rng rng(5);
    for (uint32_t t = 0; t < surface.mesh.triangle_count(); ++t)
        for (int k = 0; k < 500; ++k) {
            Point p = random_point(rng);
            if (k % 5 == 0) p.b2 = 0;
            if (k % 5 == 1) p.b2 = 1 - p.b1;
            if (k % 7 == 0) p.b1 = k % 2 ? 1.0f : 0.0f, p.b2 = k % 4 < 2 ? 1 - p.b1 : 0;
            if (k % 11 == 0) p.b2 -= 1e-6f, p.b1 += 2e-6f;  // as rasterizers round
            const TexelMix mix = surface.linear.at(t, p.b1, p.b2);
            float sum = 0;
            ASSERT_LE(mix.entries().size(), 9u);
            for (const auto& [triangle, local, weight] : mix.entries()) {
                ASSERT_LT(local, surface.atlas.tile(triangle).texels());
                ASSERT_GT(weight, 0);
                sum += weight;
            }
            ASSERT_NEAR(sum, 1, 1e-5);
        }
}

TEST_P(SurfaceLookups, NearestIsTheTexelThatThePointFallsIn) {
    Rng rng(6);
    for (uint32_t t = 0; t < surface.mesh.triangle_count(); ++t) {
        const Point p = random_point(rng);
        const TexelMix mix = surface.nearest.at(t, p.b1, p.b2);
        ASSERT_EQ(mix.entries().size(), 1u);
        EXPECT_EQ(mix.entries()[0].triangle, t);
        EXPECT_EQ(mix.entries()[0].local, surface.atlas.local_at(t, p.b1, p.b2));
        EXPECT_EQ(mix.entries()[0].weight, 1);
    }
}

// Among three neighbouring centres the look-up's weights are the point's barycentric coordinates: it takes each
// texel's value at its centre, and shows linear functions as they are.
TEST_P(SurfaceLookups, IsLinearBetweenCentres) {
    Rng rng(7);
    for (uint32_t t = 0; t < 40; ++t) {
        const TriangleTile& tile = surface.atlas.tile(t);
        const int n = tile.side();
        for (int j = 0; j + 1 < n; ++j)
            for (int i = 0; i + j + 1 < n; ++i)
                for (const int up : {1, 0}) {
                    if (!up && i + j + 2 >= n) continue;
                    const uint32_t corners[3] = {up ? tile.local_of_cell(i, j) : tile.local_of_cell(i + 1, j + 1),
                                                 tile.local_of_cell(i + 1, j), tile.local_of_cell(i, j + 1)};
                    const Point p = random_point(rng);
                    const float w[3] = {1 - p.b1 - p.b2, p.b1, p.b2};
                    float b1 = 0, b2 = 0;
                    for (size_t k = 0; k < 3; ++k) {
                        b1 += w[k] * tile.barycentric(corners[k])[1];
                        b2 += w[k] * tile.barycentric(corners[k])[2];
                    }
                    float found[3] = {};
                    const TexelMix mix = surface.linear.at(t, b1, b2);
                    for (const auto& [triangle, local, weight] : mix.entries())
                        for (size_t k = 0; k < 3; ++k)
                            if (triangle == t && local == corners[k]) found[k] += weight;
                    for (size_t k = 0; k < 3; ++k) ASSERT_NEAR(found[k], w[k], 1e-5f * float(n)) << i << " " << j;
                }
    }
}

TEST_P(SurfaceLookups, TakesATexelsValueAtItsCentre) {
    for (uint32_t t = 0; t < surface.mesh.triangle_count(); ++t)
        for (uint32_t local = 0; local < surface.atlas.tile(t).texels(); ++local) {
            const auto& b = surface.atlas.tile(t).barycentric(local);
            EXPECT_NEAR(shown(surface.linear, t, b[1], b[2]), float(random_bits(t, local) % 1000) / 1000.0f, 1e-4);
        }
}

TEST_P(SurfaceLookups, IsContinuousInsideATriangle) {
    Rng rng(8);
    float largest = 0;
    for (uint32_t t = 0; t < surface.mesh.triangle_count(); ++t)
        for (int k = 0; k < 500; ++k) {
            const Point p = random_point(rng), q = random_point(rng);
            constexpr float step = 1e-3f;
            const Point r = {p.b1 + step * (q.b1 - p.b1), p.b2 + step * (q.b2 - p.b2)};
            const int side = surface.atlas.side(t);
            const float slope = std::abs(shown(surface.linear, t, p.b1, p.b2) - shown(surface.linear, t, r.b1, r.b2)) /
                                (step * float(side));
            // Near a corner, where three triangles mix, slopes grow as its distance falls.
            const float edge[3] = {1 - p.b1 - p.b2, p.b1, p.b2};
            const float corner = (1 - *std::ranges::max_element(edge)) * float(side);
            largest = std::max(largest, slope);
            ASSERT_LT(slope, 4 + 1 / std::max(corner - step * float(side), 1e-3f)) << p.b1 << " " << p.b2;
        }
    EXPECT_GT(largest, 0.5f);  // the numbers do differ
}

// From both sides of an edge the same, but close to its ends.
TEST_P(SurfaceLookups, IsContinuousAcrossEdges) {
    const auto& triangles = surface.mesh.triangles;
    size_t compared = 0;
    double jump = 0;
    for (uint32_t t = 0; t < triangles.size(); ++t)
        for (uint32_t other = 0; other < t; ++other)
            for (size_t a = 0; a < 3; ++a)
                for (size_t b = 0; b < 3; ++b) {
                    if (triangles[t][a] != triangles[other][(b + 1) % 3] ||
                        triangles[t][(a + 1) % 3] != triangles[other][b])
                        continue;
                    for (const float at : {0.02f, 0.1f, 0.37f, 0.5f, 0.81f, 0.98f}) {
                        float mine[3] = {}, theirs[3] = {};
                        mine[a] = theirs[(b + 1) % 3] = 1 - at;
                        mine[(a + 1) % 3] = theirs[b] = at;
                        const float from_here = shown(surface.linear, t, mine[1], mine[2]),
                                    from_there = shown(surface.linear, other, theirs[1], theirs[2]);
                        EXPECT_NEAR(from_here, from_there, 1e-4) << at;
                        jump += std::abs(shown(surface.nearest, t, mine[1], mine[2]) -
                                         shown(surface.nearest, other, theirs[1], theirs[2]));
                        ++compared;
                    }
                }
    EXPECT_EQ(compared, 6 * triangles.size() * 3 / 2);  // each edge once
    EXPECT_GT(jump / double(compared), 0.2);            // as the nearest texel is not
}

INSTANTIATE_TEST_SUITE_P(Sides, SurfaceLookups, ::testing::Bool());

// A triangle with nothing across its edges, or with several, shows its outermost centres up to them.
TEST(SurfaceLookup, ShowsOneTriangleAlone) {
    const Mesh mesh = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, -1}}, {{0, 1, 2}, {1, 0, 3}, {1, 0, 4}}};
    const TriangleAtlas atlas(mesh, 4);
    const TexelLookup linear(atlas, SurfaceLookup::linear);
    for (const Point p : {Point{0.5f, 0.5f}, Point{0, 0.3f}, Point{0.4f, 0}, Point{0, 0}, Point{1, 0}, Point{0, 1}}) {
        const TexelMix mix = linear.at(0, p.b1, p.b2);
        for (const auto& entry : mix.entries()) EXPECT_EQ(entry.triangle, 0u) << p.b1 << " " << p.b2;
    }
}

TEST(SurfaceLookup, HasNames) {
    for (const auto lookup : {SurfaceLookup::nearest, SurfaceLookup::linear})
        EXPECT_EQ(surface_lookup_of(to_string(lookup)), lookup);
    EXPECT_THROW(surface_lookup_of("cubic"), std::runtime_error);
}

}  // namespace
}  // namespace radiafit

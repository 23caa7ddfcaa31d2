#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <limits>
#include <set>

#include "base/error.h"
#include "base/rng.h"
#include "geometry/atlas.h"
#include "geometry/camera.h"
#include "geometry/shortest_turn.h"
#include "geometry/vertex_rings.h"
#include "mesh_shapes.h"

namespace radiafit {
namespace {
using testing::ball;
using testing::random_mesh;

constexpr float nan_value = std::numeric_limits<float>::quiet_NaN();

Mesh one_triangle() { return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}}; }

template <class F>
std::string complaint(F&& body) {
    try {
        body();
    } catch (const UserError& error) {
        EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
        return error.what();
    }
    return "no UserError";
}

/// Degenerate by a definition of its own: two corners at one place (what random_mesh plants), nothing else.
bool corners_coincide(const Mesh& mesh, uint32_t t) {
    const auto& [a, b, c] = mesh.triangles[t];
    const auto& p = mesh.positions;
    return p[a] == p[b] || p[b] == p[c] || p[c] == p[a];
}

TEST(Mesh, DefectsOfRandomMeshes) {
    for (uint64_t seed = 0; seed < 30; ++seed) {
        const Mesh mesh = random_mesh(seed);
        const MeshDefects defects = find_defects(mesh);
        std::vector<uint32_t> degenerate, unreferenced;
        std::set<uint32_t> used;
        for (uint32_t t = 0; t < mesh.triangle_count(); ++t) {
            if (corners_coincide(mesh, t))
                degenerate.push_back(t);
            else
                used.insert(mesh.triangles[t].begin(), mesh.triangles[t].end());
        }
        for (uint32_t v = 0; v < mesh.vertex_count(); ++v)
            if (!used.count(v)) unreferenced.push_back(v);
        EXPECT_EQ(defects.degenerate_triangles, degenerate) << "seed " << seed;
        EXPECT_EQ(defects.unreferenced_vertices, unreferenced) << "seed " << seed;
        EXPECT_FALSE(degenerate.empty());
        EXPECT_FALSE(unreferenced.empty());
    }
}

TEST(Mesh, DegeneracyIsRelativeToSize) {
    Mesh mesh = one_triangle();
    for (const float scale : {1e-12f, 1.0f, 1e12f}) {
        mesh.positions = {{0, 0, 0}, {scale, 0, 0}, {0, scale, 0}};
        EXPECT_FALSE(is_degenerate(mesh, 0)) << scale;
        mesh.positions[2] = {4 * scale, 0, 0};
        EXPECT_TRUE(is_degenerate(mesh, 0)) << scale;
    }
    mesh.positions[2] = {nan_value, 0, 0};
    EXPECT_TRUE(is_degenerate(mesh, 0));
}

TEST(Mesh, ChecksNameTheMeshAndTheFault) {
    EXPECT_NE(complaint([] { check_mesh({}, "m.ply"); }).find("m.ply: the mesh is empty"), std::string::npos);
    Mesh mesh = one_triangle();
    check_mesh(mesh, "m.ply");
    mesh.triangles[0][1] = 3;
    EXPECT_NE(complaint([&] { check_mesh(mesh, "m.ply"); }).find("vertex 3"), std::string::npos);
    mesh = one_triangle();
    mesh.positions[2].y() = nan_value;
    EXPECT_NE(complaint([&] { check_mesh(mesh, "m.ply"); }).find("vertex 2 is not finite"), std::string::npos);
}

TEST(Mesh, NormalsOfABallPointOutwardAndUnreferencedOnesUp) {
    Mesh mesh = ball(12);
    mesh.positions.push_back({5, 5, 5});
    const std::vector<Vec3f> normals = vertex_normals(mesh);
    ASSERT_EQ(normals.size(), mesh.vertex_count());
    // Facets of a ball this fine turn by about 0.1 rad; area weights average most of that out.
    for (size_t v = 0; v + 1 < normals.size(); ++v) EXPECT_GT(normals[v].dot(mesh.positions[v]), 0.995f);
    EXPECT_EQ(normals.back(), Vec3f(0, 0, 1));
}

TEST(Mesh, NormalsAreWeightedByArea) {
    // Two right triangles on an edge, one in z = 0 with area 3/2, one in x = 0 with area 1/2.
    const Mesh mesh{{{0, 0, 0}, {0, 1, 0}, {-3, 0, 0}, {0, 0, -1}}, {{0, 1, 2}, {0, 3, 1}}};
    const Vec3f expected = Vec3f(1, 0, 3).normalized();  // area times unit normal: (0,0,3)/2 and (1,0,0)/2
    EXPECT_LT((vertex_normals(mesh)[0] - expected).norm(), 1e-6f);
}

TEST(ShortestTurn, TurnsOneDirectionToTheOtherByTheAngleBetweenThem) {
    Rng rng(3);
    const auto any = [&] {
        return Vec3d(double(rng.uniform(-1, 1)), double(rng.uniform(-1, 1)), double(rng.uniform(-1, 1)));
    };
    const auto check = [](const Vec3d& from, const Vec3d& to, double most_off) {
        const Eigen::Quaterniond turn = shortest_turn(from, to);
        EXPECT_NEAR(turn.norm(), 1, 1e-14);
        EXPECT_LT((turn * from.normalized() - to.normalized()).norm(), most_off);
        const double angle = std::atan2(from.cross(to).norm(), from.dot(to));
        EXPECT_NEAR(turn.angularDistance(Eigen::Quaterniond::Identity()), angle, 1e-7);
    };
    for (int i = 0; i < 1000; ++i) {
        const Vec3d from = any(), to = any();
        check(from, to, 1e-12);
        check(from, from, 1e-12);
        check(from, -from, 1e-12);
        for (const double off : {1e-3, 1e-6, 1e-8, 1e-12}) check(from, Vec3d(-from + off * to), 1e-7);
    }
}

TEST(Mesh, FramesAreRightHandedRotations) {
    Rng rng(5);
    for (int k = 0; k < 200; ++k) {
        Vec3f n(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1));
        if (k == 0) n = {0, 0, 1};
        if (k == 1) n = {0, 0, -1};
        if (k == 2) n = {1, 0, 0};
        n.normalize();
        const Frame f = make_frame(n);
        EXPECT_EQ(f.normal, n);
        EXPECT_NEAR(f.tangent.norm(), 1, 1e-6);
        EXPECT_NEAR(f.tangent.dot(n), 0, 1e-6);
        EXPECT_LT((f.tangent.cross(f.bitangent) - n).norm(), 1e-6);
        EXPECT_LT((f.to_local(n) - Vec3f(0, 0, 1)).norm(), 1e-6);
        EXPECT_NEAR(f.tangent.dot(std::abs(n.z()) < 0.9f ? Vec3f::UnitZ() : Vec3f::UnitX()), 0, 1e-6);
    }
}

TEST(Camera, LooksAtItsTargetWithUpUpwards) {
    Rng rng(1);
    for (int k = 0; k < 100; ++k) {
        const Vec3d eye(rng.uniform(-3, 3), rng.uniform(-3, 3), rng.uniform(-3, 3) + 5);
        const Vec3d target(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1));
        const Vec3d up = k == 0 ? Vec3d(target - eye) : Vec3d(0.1, 1, 0.2);
        const double fov = 0.7;
        const Camera c = Camera::look_at(eye, target, up, fov, 60, 40);
        check_camera(c, "look_at");
        EXPECT_LT((c.center() - eye).norm(), 1e-12);
        const Vec3d p = c.project(target);
        EXPECT_NEAR(p.x(), 30, 1e-9);
        EXPECT_NEAR(p.y(), 20, 1e-9);
        EXPECT_NEAR(p.z(), (target - eye).norm(), 1e-12);
        if (k == 0) continue;
        const Vec3d above = c.project(target + 0.1 * up);
        EXPECT_LT(above.y(), 20);
        EXPECT_NEAR(above.x(), 30, 1e-9);
        // The field of view is vertical: half of it above the axis reaches the upper border.
        const Vec3d d = (target - eye).normalized(), right = d.cross(up).normalized();
        const Vec3d edge = c.project(eye + std::cos(fov / 2) * d + std::sin(fov / 2) * right.cross(d));
        EXPECT_NEAR(edge.y(), 0, 1e-9);
    }
}

TEST(Camera, CroppingShiftsPixels) {
    const Camera c = Camera::look_at({1, 2, 5}, {0, 0, 0}, {0, 1, 0}, 0.5, 100, 80);
    const Camera part = c.cropped(30, 20, 40, 50);
    EXPECT_EQ(part.width, 40);
    EXPECT_EQ(part.height, 50);
    const Vec3d shift = c.project({0.1, 0.2, 0.3}) - part.project({0.1, 0.2, 0.3});
    EXPECT_LT((shift - Vec3d(30, 20, 0)).norm(), 1e-9);
}

TEST(Camera, ChecksNameTheCameraAndTheFault) {
    const Camera good = Camera::look_at({0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 0.5, 10, 10);
    const auto said = [&](auto&& spoil, const char* what) {
        Camera c = good;
        spoil(c);
        const std::string text = complaint([&] { check_camera(c, "view 7"); });
        EXPECT_EQ(text.rfind("view 7: ", 0), 0u) << text;
        EXPECT_NE(text.find(what), std::string::npos) << text;
    };
    said([](Camera& c) { c.fx = std::nan(""); }, "not finite");
    said([](Camera& c) { c.cam_from_world_translation.y() = INFINITY; }, "not finite");
    said([](Camera& c) { c.fy = 0; }, "positive");
    said([](Camera& c) { c.width = 0; }, "positive");
    said([](Camera& c) { c.fx = 1e308; }, "focal length");
    said([](Camera& c) { c.fy = 1e-9; }, "focal length");
    said([](Camera& c) { c.cx = -1e12; }, "principal point");
    said([](Camera& c) { c.cam_from_world_translation.z() = 1e15; }, "translation");
    said([](Camera& c) { c.cam_from_world_rotation *= 1.001; }, "orthonormal");
    said([](Camera& c) { c.cam_from_world_rotation.row(0) *= -1; }, "orthonormal");  // a mirror
    Camera nearly = good;
    nearly.cam_from_world_rotation *= 1 + 2e-5;
    check_camera(nearly, "single precision from a file");
}

TEST(VertexRings, HoldEveryCornerOnce) {
    size_t largest = 0;
    for (uint64_t seed = 0; seed < 60; ++seed) {
        const Mesh mesh = random_mesh(seed);
        const VertexRings rings(mesh);
        ASSERT_EQ(rings.vertex_count(), mesh.vertex_count());
        std::set<std::pair<uint32_t, uint32_t>> seen;
        for (uint32_t v = 0; v < mesh.vertex_count(); ++v) {
            const auto ring = rings.ring(v);
            for (size_t k = 0; k < ring.size(); ++k) {
                EXPECT_EQ(mesh.triangles[ring[k].triangle][ring[k].corner], v);
                EXPECT_TRUE(seen.emplace(ring[k].triangle, ring[k].corner).second);
                if (k > 0) {
                    EXPECT_LT(ring[k - 1].triangle, ring[k].triangle);
                }
                EXPECT_FALSE(corners_coincide(mesh, ring[k].triangle));
            }
        }
        size_t sound = 0;
        for (uint32_t t = 0; t < mesh.triangle_count(); ++t) sound += !corners_coincide(mesh, t);
        EXPECT_EQ(seen.size(), 3 * sound);
        largest = std::max(largest, rings.max_valence());
    }
    EXPECT_GE(largest, 90u);  // random_mesh goes to 100; or the test says little
}

TEST(VertexRings, KnowEveryValence) {
    Rng rng(3);
    for (int valence = 1; valence <= 100; ++valence)
        for (const bool closed : {false, true}) {
            if (closed && valence < 3) continue;
            const VertexRings rings(testing::fan(valence, closed, rng));
            EXPECT_EQ(rings.ring(0).size(), size_t(valence));
            EXPECT_EQ(rings.max_valence(), std::max<size_t>(valence, closed || valence > 1 ? 2 : 1));
            EXPECT_EQ(rings.ring(1).size(), closed ? 2u : 1u);
        }
}

/// Every texel's place, and that no two share one.
void expect_places_apart(const Atlas& atlas) {
    std::vector<uint8_t> taken(size_t(atlas.width()) * atlas.height(), 0);
    for (uint32_t texel = 0; texel < atlas.texel_count(); ++texel) {
        const auto [x, y] = atlas.place(texel);
        ASSERT_TRUE(x >= 0 && x < atlas.width() && y >= 0 && y < atlas.height()) << "texel " << texel;
        uint8_t& here = taken[size_t(y) * atlas.width() + x];
        ASSERT_EQ(here, 0) << "texel " << texel << " shares a place";
        here = 1;
    }
}

TEST(TriangleAtlas, PlacesAreDistinctAndWithinBounds) {
    for (const int side : {2, 3, 8, 16, 33, 64})
        for (uint64_t seed = 0; seed < 3; ++seed) {
            const Mesh mesh = random_mesh(seed);
            const TriangleAtlas atlas(mesh, side);
            SCOPED_TRACE(::testing::Message() << mesh.triangle_count() << " triangles, side " << side);
            EXPECT_EQ(atlas.tile_count(), mesh.triangle_count());
            EXPECT_EQ(atlas.texels_per_tile(), uint32_t(side * (side + 1) / 2));
            expect_places_apart(atlas);
        }
    for (uint32_t triangles = 1; triangles < 40; ++triangles) {
        Mesh mesh = one_triangle();
        mesh.triangles.resize(triangles, mesh.triangles[0]);
        expect_places_apart(TriangleAtlas(mesh, 5));
    }
}

TEST(TriangleAtlas, TilesOfTheirOwnSides) {
    const Mesh mesh = random_mesh(3);
    Rng rng(5);
    std::vector<uint8_t> sides;
    uint64_t used = 0;
    for (uint32_t t = 0; t < mesh.triangle_count(); ++t) {
        sides.push_back(uint8_t(2 + rng.index(12)));
        used += uint64_t(sides.back()) * (sides.back() + 1u) / 2;
    }
    const TriangleAtlas atlas(mesh, 13, std::make_shared<const std::vector<uint8_t>>(sides)), even(mesh, 13);
    EXPECT_EQ(atlas.used_texels(), used);
    EXPECT_EQ(even.used_texels(), even.texel_count());
    EXPECT_EQ(atlas.texel_count(), even.texel_count());
    EXPECT_EQ(atlas.width(), even.width());
    EXPECT_EQ(atlas.height(), even.height());
    std::set<std::array<int, 2>> places;
    for (uint32_t t = 0; t < mesh.triangle_count(); ++t)
        for (uint32_t local = 0; local < atlas.texels_per_tile(); ++local) {
            const uint32_t texel = t * atlas.texels_per_tile() + local;
            const bool is_one = local < atlas.tile(t).texels();
            ASSERT_EQ(atlas.usable(texel), is_one && !atlas.degenerate(t));
            if (!is_one) continue;
            const auto place = atlas.place(texel);
            ASSERT_TRUE(places.insert(place).second);
            ASSERT_LT(place[0], atlas.width());
            ASSERT_LT(place[1], atlas.height());
            const auto b = TriangleTile::of_side(sides[t]).barycentric(local);
            ASSERT_EQ(atlas.local_at(t, b[1], b[2]), local);
        }
    const auto with = [&](std::vector<uint8_t> wrong) {
        return complaint([&] { TriangleAtlas(mesh, 13, std::make_shared<const std::vector<uint8_t>>(wrong)); });
    };
    sides[7] = 14;
    EXPECT_NE(with(sides).find("triangle 7's surface map has side 14"), std::string::npos);
    sides[7] = 1;
    EXPECT_NE(with(sides).find("side 1"), std::string::npos);
    sides.pop_back();
    EXPECT_NE(with(sides).find("triangles"), std::string::npos);
}

TEST(TriangleAtlas, LayoutIsNearlySquareAndWastesLittle) {
    Mesh mesh = one_triangle();
    mesh.triangles.resize(6100, mesh.triangles[0]);
    const TriangleAtlas atlas(mesh, 8);
    EXPECT_NEAR(atlas.width(), 480, 24);
    EXPECT_NEAR(atlas.height(), 460, 24);
    // Only the last row of rectangles may be unfilled.
    EXPECT_GT(double(atlas.texel_count()) / (atlas.width() * atlas.height()), 0.97);
}

TEST(TriangleTile, CentersLieInTheirCells) {
    for (int side = 2; side <= 64; ++side) {
        const TriangleTile& tile = TriangleTile::of_side(side);
        for (uint32_t local = 0; local < tile.texels(); ++local) {
            const auto b = tile.barycentric(local);
            const auto [i, j] = tile.cell(local);
            EXPECT_EQ(tile.local_of_cell(i, j), local);
            ASSERT_EQ(tile.local_at(b[1], b[2]), local) << "side " << side;
            EXPECT_NEAR(b[0] + b[1] + b[2], 1, 1e-6);
            EXPECT_GT(b[0], 0);
        }
    }
}

TEST(TriangleTile, CellsTileTheTriangle) {
    // Uniform points of the triangle (in barycentric coordinates, where all triangles are alike): each cell's share is
    // its area, and their mean its centroid. Whole cells have area 2/n² of the triangle, the n diagonal halves 1/n².
    Rng rng(11);
    for (const int side : {2, 3, 8, 13}) {
        const TriangleTile& tile = TriangleTile::of_side(side);
        const int points = 200000;
        std::vector<int> count(tile.texels(), 0);
        std::vector<std::array<double, 2>> sum(tile.texels(), {0, 0});
        for (int k = 0; k < points; ++k) {
            float b1 = rng.uniform(), b2 = rng.uniform();
            if (b1 + b2 > 1) b1 = 1 - b1, b2 = 1 - b2;
            const uint32_t local = tile.local_at(b1, b2);
            ASSERT_LT(local, tile.texels());
            ++count[local];
            sum[local][0] += b1;
            sum[local][1] += b2;
        }
        for (uint32_t local = 0; local < tile.texels(); ++local) {
            const auto [i, j] = tile.cell(local);
            const double share = (i + j == side - 1 ? 1.0 : 2.0) / (side * side);
            // Five standard deviations of a binomial count, and of a mean within a cell of size 1/n.
            EXPECT_NEAR(count[local], points * share, 5 * std::sqrt(points * share)) << side << ": " << i << ", " << j;
            const double tolerance = 5 * 0.3 / side / std::sqrt(double(count[local]));
            EXPECT_NEAR(sum[local][0] / count[local], tile.barycentric(local)[1], tolerance);
            EXPECT_NEAR(sum[local][1] / count[local], tile.barycentric(local)[2], tolerance);
        }
    }
}

TEST(TriangleTile, RimRoundingStaysInTheTile) {
    Rng rng(2);
    for (int side = 2; side <= 64; ++side) {
        const TriangleTile& tile = TriangleTile::of_side(side);
        for (int k = 0; k <= 1000; ++k) {
            const float b1 = k <= 2 * side ? float(k) / float(2 * side) : rng.uniform();
            for (const float b2 : {1 - b1, std::nextafter(1 - b1, 2.0f), 0.0f, -1e-7f}) {
                const uint32_t local = tile.local_at(b1, b2);
                ASSERT_LT(local, tile.texels());
                const auto [i, j] = tile.cell(local);
                // Within a cell's width of the asked point, or on its border.
                EXPECT_LE(std::abs(float(i) + 0.5f - b1 * float(side)), 1.5001f);
                EXPECT_LE(std::abs(float(j) + 0.5f - b2 * float(side)), 1.5001f);
            }
        }
    }
}

TEST(TriangleAtlas, PositionsAndNormalsInterpolate) {
    const Mesh mesh = ball(10);
    const TriangleAtlas atlas(mesh, 4);
    for (uint32_t texel = 0; texel < atlas.texel_count(); ++texel) {
        const auto& [a, b, c] = mesh.triangles[texel / atlas.texels_per_tile()];
        const auto w = atlas.tile(0).barycentric(texel % atlas.texels_per_tile());
        const Vec3f p = atlas.position(texel);
        // Solve for the weights again, in double, from the position.
        Mat3d corners;
        corners << mesh.positions[a].cast<double>(), mesh.positions[b].cast<double>(), mesh.positions[c].cast<double>();
        const Vec3d q = p.cast<double>();
        const double det = corners.col(0).dot(corners.col(1).cross(corners.col(2)));
        const double b1 = corners.col(0).dot(q.cross(corners.col(2))) / det;
        const double b2 = corners.col(0).dot(corners.col(1).cross(q)) / det;
        ASSERT_NEAR(b1, w[1], 1e-5);  // a position's last bit over a triangle of size 0.15
        ASSERT_NEAR(b2, w[2], 1e-5);
        const Vec3f n = atlas.normal(texel);
        ASSERT_NEAR(n.norm(), 1, 1e-6);
        ASSERT_GT(n.dot(p.normalized()), 0.99f);
        ASSERT_TRUE(atlas.usable(texel));
    }
}

TEST(TriangleAtlas, DegenerateTilesAreNotUsable) {
    const Mesh mesh = random_mesh(4);
    const TriangleAtlas atlas(mesh, 3);
    for (uint32_t texel = 0; texel < atlas.texel_count(); ++texel) {
        const uint32_t t = texel / atlas.texels_per_tile();
        EXPECT_EQ(atlas.usable(texel), !corners_coincide(mesh, t));
        EXPECT_EQ(atlas.degenerate(t), corners_coincide(mesh, t));
        EXPECT_NEAR(atlas.normal(texel).norm(), 1, 1e-5);
    }
}

TEST(TriangleAtlas, RefusesWhatDoesNotFit) {
    Mesh mesh = one_triangle();
    for (const int side : {-1, 0, 1, 65}) EXPECT_THROW(TriangleAtlas(mesh, side), UserError) << side;
    mesh.triangles.resize(140000, mesh.triangles[0]);  // 70,000 rectangles of 64 x 65: 17,000 squared
    EXPECT_NE(complaint([&] { TriangleAtlas(mesh, 64); }).find("16384"), std::string::npos);
    TriangleAtlas(mesh, 32);
}

TEST(GridAtlas, IsTheIdentityLayout) {
    const int width = 7, height = 5;
    std::vector<Vec3f> positions, normals(width * height, Vec3f::UnitZ());
    std::vector<uint8_t> usable;
    for (int k = 0; k < width * height; ++k) {
        positions.push_back({float(k), 1, 2});
        usable.push_back(k % 3 == 0);
    }
    const GridAtlas atlas(width, height, positions, normals, usable);
    EXPECT_EQ(atlas.tile_count(), 1u);
    EXPECT_EQ(atlas.texel_count(), 35u);
    expect_places_apart(atlas);
    for (uint32_t k = 0; k < 35; ++k) {
        EXPECT_EQ(atlas.place(k), (std::array<int, 2>{int(k) % 7, int(k) / 7}));
        EXPECT_EQ(atlas.position(k), positions[k]);
        EXPECT_EQ(atlas.normal(k), Vec3f(0, 0, 1));
        EXPECT_EQ(atlas.usable(k), k % 3 == 0);
    }
    EXPECT_TRUE(GridAtlas(width, height, positions, normals, {}).usable(1));
    EXPECT_THROW(GridAtlas(width, height + 1, positions, normals, {}), UserError);
    EXPECT_THROW(GridAtlas(width, height, positions, normals, {1}), UserError);
    EXPECT_THROW(GridAtlas(0, 0, {}, {}, {}), UserError);
}

}  // namespace
}  // namespace radiafit

#include "geometry/mesh_part.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <numeric>

#include "geometry/raster.h"
#include "samples/raster_distributor.h"
#include "scenes.h"

namespace radiafit {
namespace {
using testing::sheet_dataset;
using testing::troubled_mesh;

std::shared_ptr<const Mesh> borrowed(const Mesh& mesh) { return {std::shared_ptr<const Mesh>(), &mesh}; }

std::vector<std::vector<uint32_t>> vertex_groups(const Mesh& mesh, size_t count) {
    return groups_of_neighbours(mesh.positions, std::vector<uint64_t>(mesh.vertex_count(), 1), count);
}

TEST(Groups, HoldEveryPointOnceAndAreBalanced) {
    const Mesh mesh = troubled_mesh(20, 7, 1);
    std::vector<uint64_t> weights;
    for (size_t v = 0; v < mesh.vertex_count(); ++v) weights.push_back(1 + random_bits(3, v) % 9);
    const double whole = double(std::accumulate(weights.begin(), weights.end(), uint64_t(0)));
    for (const size_t count : {1, 2, 7, 50}) {
        const auto groups = groups_of_neighbours(mesh.positions, weights, count);
        ASSERT_EQ(groups.size(), count);
        std::vector<int> seen(mesh.vertex_count(), 0);
        for (const auto& group : groups) {
            EXPECT_TRUE(std::ranges::is_sorted(group));
            double weight = 0;
            for (const uint32_t v : group) ++seen[v], weight += double(weights[v]);
            EXPECT_NEAR(weight, whole / double(count), 10);
        }
        EXPECT_TRUE(std::ranges::all_of(seen, [](int times) { return times == 1; }));
    }
}

TEST(Groups, AreCompact) {
    const Mesh mesh = troubled_mesh(40, 7, 1);
    double parts = 0;
    for (const auto& group : vertex_groups(mesh, 16)) {
        std::vector<Vec3f> points;
        for (const uint32_t v : group) points.push_back(mesh.positions[v]);
        const Box box = bounding_box(points);
        parts += double(box.high.x() - box.low.x()) * double(box.high.y() - box.low.y());
    }
    const Box whole = bounding_box(mesh.positions);
    EXPECT_LT(parts, 2 * double(whole.high.x() - whole.low.x()) * double(whole.high.y() - whole.low.y()));
}

TEST(Groups, MayBeMoreThanPoints) {
    const std::vector<Vec3f> points = {{0, 0, 0}, {1, 0, 0}};
    const std::vector<uint64_t> weights = {1, 1};
    size_t held = 0;
    for (const auto& group : groups_of_neighbours(points, weights, 5)) held += group.size();
    EXPECT_EQ(held, 2u);
}

TEST(Part, KeepsRingsFramesAndBlocksOfItsVertices) {
    const Mesh whole = troubled_mesh(6, 7, 1);
    const VertexRings rings(whole);
    const auto frames = vertex_frames(whole);
    size_t fitted = 0;
    for (const auto& group : vertex_groups(whole, 5)) {
        const Mesh part = part_around(borrowed(whole), rings, group);
        const Surroundings& around = *part.surroundings;
        const VertexRings own(part);
        const auto own_frames = vertex_frames(part);
        std::vector<uint32_t> with_problem;
        for (uint32_t v = 0; v < part.vertex_count(); ++v) {
            EXPECT_EQ(part.positions[v], whole.positions[around.vertices[v]]);
            if (around.rim[v]) {
                EXPECT_TRUE(own.ring(v).empty());
                continue;
            }
            with_problem.push_back(around.vertices[v]);
            const auto ring = own.ring(v), expected = rings.ring(around.vertices[v]);
            ASSERT_EQ(ring.size(), expected.size());
            for (size_t i = 0; i < ring.size(); ++i) {
                EXPECT_EQ(around.triangles[ring[i].triangle], expected[i].triangle);
                EXPECT_EQ(ring[i].corner, expected[i].corner);
            }
            EXPECT_EQ(std::memcmp(&own_frames[v], &frames[around.vertices[v]], sizeof(Frame)), 0);
        }
        EXPECT_EQ(with_problem, group);
        for (uint32_t t = 0; t < part.triangle_count(); ++t) {
            EXPECT_EQ(around.part_triangle[around.triangles[t]], t);
            for (int c = 0; c < 3; ++c)
                EXPECT_EQ(around.vertices[part.triangles[t][c]], whole.triangles[around.triangles[t]][c]);
        }
        fitted += with_problem.size();
    }
    EXPECT_EQ(fitted, whole.vertex_count());
}

TEST(Part, HaloAddsTheTrianglesAroundItsTriangles) {
    const Mesh whole = troubled_mesh(8, 7, 1);
    const VertexRings rings(whole);
    const std::vector<uint32_t> one = {40};
    const Mesh none = part_around(borrowed(whole), rings, one), halo = part_around(borrowed(whole), rings, one, 1);
    EXPECT_EQ(none.triangle_count(), rings.ring(40).size());
    std::vector<uint8_t> expected(whole.triangle_count(), 0);
    for (const uint32_t t : none.surroundings->triangles)
        for (const uint32_t v : whole.triangles[t])
            for (const Corner& corner : rings.ring(v)) expected[corner.triangle] = 1;
    EXPECT_EQ(halo.triangle_count(), size_t(std::count(expected.begin(), expected.end(), 1)));
    for (const uint32_t t : halo.surroundings->triangles) EXPECT_TRUE(expected[t]);
}

/// What hides a part still hides it: its texels take the pixels that they take in the whole.
TEST(Part, TakesTheSamePixels) {
    const Dataset dataset = sheet_dataset(troubled_mesh(6, 7, 1), 6, 80, 2);
    const Mesh& whole = dataset.mesh;
    const TriangleAtlas atlas(whole, 4);
    RasterDistributor distributor(atlas);
    const VertexRings rings(whole);
    uint32_t kept = 0;
    for (const auto& group : vertex_groups(whole, 3)) {
        const Mesh part = part_around(borrowed(whole), rings, group);
        const TriangleAtlas own(part, 4);
        RasterDistributor own_distributor(own);
        for (const View& view : dataset.views) {
            TargetImage image;
            image.width = view.camera.width;
            image.height = view.camera.height;
            image.bits = 8;
            image.rgba8.assign(size_t(image.width) * size_t(image.height) * 4, 255);
            Distribution expected, got;
            distributor.distribute(view.camera, image, expected);
            own_distributor.distribute(view.camera, image, got);
            const uint32_t texels = atlas.texels_per_tile();
            for (uint32_t t = 0; t < part.triangle_count(); ++t)
                for (uint32_t local = 0; local < texels; ++local)
                    EXPECT_EQ(got.texel_pixel[t * texels + local],
                              expected.texel_pixel[part.surroundings->triangles[t] * texels + local]);
            kept += got.kept_pixels;
        }
    }
    EXPECT_GT(kept, 1000u);
}

TEST(MayShow, IsTrueWhereverAVertexIsInTheImage) {
    int hidden = 0;
    for (uint64_t seed = 0; seed < 400; ++seed) {
        Rng rng(seed);
        const auto point = [&] { return Vec3d(rng.uniform(-3, 3), rng.uniform(-3, 3), rng.uniform(-3, 3)); };
        const Camera camera = Camera::look_at(point(), point(), {0.1, 1, 0.2}, 0.7, 60, 40);
        std::vector<Vec3f> points;
        for (int i = 0; i < 6; ++i)
            points.push_back(Vec3f(0.4f * point().cast<float>() + point().cast<float>() * 0.05f));
        const bool may = may_show(camera, bounding_box(points));
        hidden += !may;
        for (const Vec3f& p : points) {
            const Vec3d at = camera.project(p.cast<double>());
            const bool inside = at.z() > 0 && at.x() >= 0 && at.x() < 60 && at.y() >= 0 && at.y() < 40;
            EXPECT_TRUE(may || !inside) << seed;
        }
    }
    EXPECT_GT(hidden, 20);
}

}  // namespace
}  // namespace radiafit

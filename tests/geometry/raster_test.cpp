#include "geometry/raster.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <set>

#include "geometry/ray_cast.h"
#include "mesh_shapes.h"

namespace radiafit {
namespace {
using testing::ball;

/// At the origin, looking along +z: a point (x, y, 1) appears at pixel (size x + size/2, size y + size/2).
Camera straight_camera(int size) {
    Camera c;
    c.width = c.height = size;
    c.fx = c.fy = size;
    c.cx = c.cy = 0.5 * size;
    return c;
}

/// The world point at depth z that appears at pixel coordinates (x, y); exact for z = 1 and multiples of 1/2 pixel.
Vec3f at_pixel(const Camera& c, double x, double y, double z = 1) {
    return {float((x - c.cx) / c.fx * z), float((y - c.cy) / c.fy * z), float(z)};
}

Vec3d ray_direction(const Camera& c, int x, int y) {
    return c.cam_from_world_rotation.transpose() * Vec3d((x + 0.5 - c.cx) / c.fx, (y + 0.5 - c.cy) / c.fy, 1);
}

size_t covered(const Rasterizer& r) {
    return size_t(std::count_if(r.pixels().begin(), r.pixels().end(),
                                [](const RasterPixel& p) { return p.triangle != no_triangle; }));
}

/// Distance of p to the segment ab, pixels.
double distance_to(const Vec2d& p, const Vec2d& a, const Vec2d& b) {
    const Vec2d d = b - a;
    const double s = d.squaredNorm() > 0 ? std::clamp((p - a).dot(d) / d.squaredNorm(), 0.0, 1.0) : 0;
    return (p - a - s * d).norm();
}

TEST(Raster, CounterClockwiseFromTheEyeIsFront) {
    // +x right, +y down, +z forward: seen from the origin, right, then up (-y) from a corner is counter-clockwise.
    const Camera c = straight_camera(20);
    Mesh mesh{{at_pixel(c, 4, 16), at_pixel(c, 16, 16), at_pixel(c, 4, 4)}, {{0, 1, 2}}};
    // The outward normal (counter-clockwise rule) faces the eye.
    const Vec3f normal = (mesh.positions[1] - mesh.positions[0]).cross(mesh.positions[2] - mesh.positions[0]);
    ASSERT_LT(normal.z(), 0);
    Rasterizer r;
    r.draw(mesh, c);
    // Half of a 12 x 12 square. Of the 12 pixel centres on the hypotenuse, from top left to bottom right, none count:
    // it is a right edge.
    EXPECT_EQ(covered(r), 66u);
    EXPECT_EQ(r.pixels()[15 * 20 + 4].triangle, 0u);  // row 0 is on top
    EXPECT_EQ(r.pixels()[4 * 20 + 15].triangle, no_triangle);
    std::swap(mesh.triangles[0][1], mesh.triangles[0][2]);
    r.draw(mesh, c);
    EXPECT_EQ(covered(r), 0u);
}

TEST(Raster, ExtremeCamerasDrawFiniteNumbers) {
    const Mesh mesh{{{-1, -1, 2}, {1, -1, 3}, {1, 1, 2}, {-1, 1, 1e30f}, {0, 0, 1e-5f}},
                    {{0, 2, 1}, {0, 3, 2}, {0, 1, 4}, {1, 2, 4}, {2, 3, 4}}};
    Camera turned = Camera::look_at({0.3, 0.2, 0}, {0.1, 0, 5}, {0, 1, 0}, 0.7, 20, 20);
    Rasterizer r;
    for (const double f : {1e-3, 20.0, 1e9, 1e150, 1e308})
        for (const double middle : {10.0, -1e9, 1e9, 1e300})
            for (const double z : {0.0, 1e12, 1e300}) {
                turned.fx = turned.fy = f;
                turned.cx = turned.cy = middle;
                turned.cam_from_world_translation.z() = z;
                r.draw(mesh, turned);
                for (const RasterPixel& p : r.pixels()) {
                    ASSERT_TRUE(p.triangle == no_triangle || p.triangle < mesh.triangle_count());
                    ASSERT_TRUE(std::isfinite(p.b1) && std::isfinite(p.b2));
                }
            }
}

TEST(Raster, BarycentricsAndDepthOfAKnownTriangle) {
    const Camera c = straight_camera(8);
    // Depths 1, 2, 4 at pixels (0, 8), (8, 8), (0, 0). At pixel centre (2.5, 5.5) the image-space weights are
    // l1 = 2.5/8, l2 = 2.5/8, l0 = 3/8; 1/z = l0 + l1/2 + l2/4 and b1 = (l1/2) z, b2 = (l2/4) z.
    const Mesh mesh{{at_pixel(c, 0, 8, 1), at_pixel(c, 8, 8, 2), at_pixel(c, 0, 0, 4)}, {{0, 1, 2}}};
    Rasterizer r;
    r.draw(mesh, c);
    const double l = 2.5 / 8, iz = 3.0 / 8 + l / 2 + l / 4;
    EXPECT_NEAR(r.inverse_depth()[5 * 8 + 2], iz, 1e-7);
    EXPECT_NEAR(r.pixels()[5 * 8 + 2].b1, l / 2 / iz, 1e-7);
    EXPECT_NEAR(r.pixels()[5 * 8 + 2].b2, l / 4 / iz, 1e-7);
}

/// Compares with rays through every pixel centre.
void expect_like_rays(const Mesh& mesh, const Camera& c, double allowed_share) {
    Rasterizer r;
    r.draw(mesh, c);
    const RayCaster rays(mesh);

    std::vector<Vec2d> image(mesh.vertex_count());
    std::vector<double> inverse_z(mesh.vertex_count());
    for (size_t v = 0; v < mesh.vertex_count(); ++v) {
        const Vec3d p = c.project(mesh.positions[v].cast<double>());
        image[v] = p.head<2>();
        inverse_z[v] = 1 / p.z();
    }
    // The rasterizer rounds vertices to 2^-14 of a pixel, so edges move by 0.5 sqrt(2) 2^-14 = 4.3e-5 pixels at most.
    // Pixel centres within 1e-4 of an edge (of any triangle, also a hidden one's) may differ and are left out.
    std::vector<uint8_t> near_edge(size_t(c.width) * c.height, 0);
    for (const auto& t : mesh.triangles)
        for (int k = 0; k < 3; ++k) {
            const Vec2d a = image[t[k]], b = image[t[(k + 1) % 3]];
            const int x0 = std::max(0, int(std::min(a.x(), b.x()) - 1)),
                      y0 = std::max(0, int(std::min(a.y(), b.y()) - 1));
            for (int y = y0; y < std::min<double>(c.height, std::max(a.y(), b.y()) + 1); ++y)
                for (int x = x0; x < std::min<double>(c.width, std::max(a.x(), b.x()) + 1); ++x)
                    if (distance_to({x + 0.5, y + 0.5}, a, b) < 1e-4) near_edge[size_t(y) * c.width + x] = 1;
        }

    size_t seen = 0, left_out = 0;
    for (int y = 0; y < c.height; ++y)
        for (int x = 0; x < c.width; ++x) {
            const size_t k = size_t(y) * c.width + x;
            const RasterPixel& p = r.pixels()[k];
            const RayHit hit = rays.closest(c.center(), ray_direction(c, x, y), INFINITY, RayCaster::Faces::front);
            seen += hit.hit();
            if (near_edge[k]) {
                ++left_out;
                continue;
            }
            ASSERT_EQ(p.triangle, hit.triangle) << "pixel " << x << ", " << y;
            if (!hit.hit()) {
                ASSERT_EQ(r.inverse_depth()[k], 0);
                continue;
            }
            // The same rounding seen as a shift of the pixel in the triangle: over its least height in pixels, and
            // times the ratio of its depths for the perspective.
            const auto& t = mesh.triangles[p.triangle];
            const Vec2d e1 = image[t[1]] - image[t[0]], e2 = image[t[2]] - image[t[0]];
            const double area = std::abs(e1.x() * e2.y() - e1.y() * e2.x());
            const double height = area / std::max({e1.norm(), e2.norm(), (e2 - e1).norm()});
            const auto [low, high] = std::minmax({inverse_z[t[0]], inverse_z[t[1]], inverse_z[t[2]]});
            const double tolerance = 1e-4 / height * (high / low) * (high / low) + 1e-6;
            ASSERT_NEAR(p.b1, hit.b1, tolerance) << "pixel " << x << ", " << y;
            ASSERT_NEAR(p.b2, hit.b2, tolerance) << "pixel " << x << ", " << y;
            ASSERT_NEAR(r.inverse_depth()[k], 1 / hit.t, 2 * tolerance * (high - low) + 2e-7 / hit.t);
        }
    EXPECT_GT(seen, r.pixels().size() / 5);  // or there was nothing to compare
    EXPECT_LE(double(left_out), allowed_share * double(r.pixels().size()));
}

TEST(Raster, SeesWhatRaysSee) {
    Rng rng(7);
    for (int k = 0; k < 6; ++k) {
        const Mesh mesh = ball(6 + 5 * k, k % 2 ? 0.4f : 0.0f);
        const Vec3d eye = Vec3d(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1)).normalized() * 4;
        // An odd size: the image's middle is a pixel centre.
        Camera c = Camera::look_at(eye, {0, 0, 0}, {0.1, 1, 0}, 0.6, 150 + k, 131);
        c.cx += rng.uniform(-9, 9);
        c.fy *= 1.1;
        SCOPED_TRACE(::testing::Message() << "mesh " << k);
        // Edges cover the image with about one pixel length in three; 2e-4 of that is near an edge.
        expect_like_rays(mesh, c, 1e-3);
    }
}

TEST(Raster, SeesWhatRaysSeeFromCloseBy) {
    // Strong perspective inside single triangles: an octahedron, 0.25 from a face, much of it outside of the image.
    const Camera c = Camera::look_at({0.5, 0.45, 0.5}, {0, 0.05, 0}, {0, 1, 0}, 1.9, 120, 90);
    expect_like_rays(ball(1), c, 1e-3);
}

/// A square tessellated by a grid of jittered vertices, each cell cut along a random diagonal; facing the eye.
Mesh tessellation(const Camera& c, int cells, int margin, int mode, Rng& rng) {
    Mesh mesh;
    const double step = double(c.width - 2 * margin) / cells;
    for (int j = 0; j <= cells; ++j)
        for (int i = 0; i <= cells; ++i) {
            double x = margin + i * step, y = margin + j * step;
            if (i > 0 && i < cells && j > 0 && j < cells) {
                x += rng.uniform(-0.3f, 0.3f) * step;
                y += rng.uniform(-0.3f, 0.3f) * step;
                if (mode == 1) x = std::floor(x) + 0.5, y = std::floor(y) + 0.5;  // on pixel centres
                if (mode == 2) x = std::round(x), y = std::floor(y) + 0.5;        // on pixel borders
            }
            mesh.positions.push_back(at_pixel(c, x, y));
        }
    const auto id = [&](int i, int j) { return static_cast<uint32_t>(j * (cells + 1) + i); };
    for (int j = 0; j < cells; ++j)
        for (int i = 0; i < cells; ++i) {
            const uint32_t a = id(i, j), b = id(i + 1, j), d = id(i, j + 1), e = id(i + 1, j + 1);
            if (rng.index(2)) {
                mesh.triangles.push_back({a, d, b});
                mesh.triangles.push_back({b, d, e});
            } else {
                mesh.triangles.push_back({a, d, e});
                mesh.triangles.push_back({a, e, b});
            }
        }
    return mesh;
}

TEST(Raster, SharedEdgesNeitherLeakNorCoverTwice) {
    // Drawn one by one, the triangles of a tessellated square must cover each pixel centre within it exactly once,
    // also where vertices and edges pass through pixel centres.
    Rng rng(17);
    const Camera c = straight_camera(64);
    const int margin = 4;
    for (int round = 0; round < 12; ++round) {
        const Mesh mesh = tessellation(c, 6, margin, round % 3, rng);
        std::vector<int> count(64 * 64, 0);
        Rasterizer r;
        for (const auto& t : mesh.triangles) {
            r.draw({mesh.positions, {t}}, c);
            for (size_t k = 0; k < count.size(); ++k) count[k] += r.pixels()[k].triangle != no_triangle;
        }
        r.draw(mesh, c);
        for (int y = 0; y < 64; ++y)
            for (int x = 0; x < 64; ++x) {
                const bool within = x >= margin && x < 64 - margin && y >= margin && y < 64 - margin;
                ASSERT_EQ(count[y * 64 + x], within ? 1 : 0) << "round " << round << ", pixel " << x << ", " << y;
                ASSERT_EQ(r.pixels()[y * 64 + x].triangle != no_triangle, within);
            }
    }
}

TEST(Raster, TopLeftRule) {
    // A square of two triangles whose border passes through pixel centres: its top and left rows count, the others not.
    const Camera c = straight_camera(16);
    const Mesh mesh{{at_pixel(c, 2.5, 3.5), at_pixel(c, 10.5, 3.5), at_pixel(c, 2.5, 9.5), at_pixel(c, 10.5, 9.5)},
                    {{0, 2, 1}, {1, 2, 3}}};
    Rasterizer r;
    r.draw(mesh, c);
    for (int y = 0; y < 16; ++y)
        for (int x = 0; x < 16; ++x)
            EXPECT_EQ(r.pixels()[y * 16 + x].triangle != no_triangle, x >= 2 && x < 10 && y >= 3 && y < 9)
                << x << ", " << y;
}

TEST(Raster, ClosedMeshesHaveNoHoles) {
    // Every pixel centre well within a convex silhouette is covered; the mesh is fine: triangles down to a third of a
    // pixel, and slivers at the silhouette.
    const Mesh mesh = ball(60);
    Rng rng(23);
    Rasterizer r;
    for (int k = 0; k < 4; ++k) {
        const Vec3d eye = Vec3d(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1)).normalized() * 5;
        const Camera c = Camera::look_at(eye, {0, 0, 0}, {0.1, 1, 0}, 0.5, 101, 101);
        r.draw(mesh, c);
        size_t inside = 0;
        for (int y = 0; y < c.height; ++y)
            for (int x = 0; x < c.width; ++x) {
                // The facets lie within 1e-3 of the unit sphere.
                const Vec3d d = ray_direction(c, x, y).normalized();
                const double distance = (-eye - d * d.dot(-eye)).norm();
                if (distance < 0.998) {
                    ++inside;
                    ASSERT_NE(r.pixels()[size_t(y) * c.width + x].triangle, no_triangle) << x << ", " << y;
                } else if (distance > 1) {
                    ASSERT_EQ(r.pixels()[size_t(y) * c.width + x].triangle, no_triangle) << x << ", " << y;
                }
            }
        EXPECT_GT(inside, 4000u);
    }
}

TEST(Raster, NearerWinsInEitherOrderAndTiesGoToTheLowerIndex) {
    const Camera c = straight_camera(16);
    Mesh mesh;
    for (const double z : {2.0, 1.5})
        for (const Vec2d& p : {Vec2d(1, 15), Vec2d(15, 15), Vec2d(1, 1)})
            mesh.positions.push_back(at_pixel(c, p.x(), p.y(), z));
    const std::array<uint32_t, 3> far{0, 1, 2}, near{3, 4, 5};
    const auto winner = [&](const std::vector<std::array<uint32_t, 3>>& triangles) {
        Rasterizer r;
        r.draw({mesh.positions, triangles}, c);
        std::set<uint32_t> seen;
        for (const RasterPixel& p : r.pixels()) seen.insert(p.triangle);
        EXPECT_EQ(seen.size(), 2u);  // one triangle, and nothing
        return *seen.begin();
    };
    EXPECT_EQ(winner({far, near}), 1u);
    EXPECT_EQ(winner({near, far}), 0u);
    EXPECT_EQ(winner({near, near, near}), 0u);
    EXPECT_EQ(winner({far, near, {4, 5, 3}}), 1u);
}

TEST(Raster, DropsWhatReachesBehindTheCameraAndWhatIsDegenerate) {
    const Camera c = straight_camera(16);
    const Vec3f a = at_pixel(c, 1, 15), b = at_pixel(c, 15, 15), d = at_pixel(c, 1, 1);
    Rasterizer r;
    r.draw({{a, b, d}, {{0, 1, 2}}}, c);
    EXPECT_GT(covered(r), 80u);
    for (const float z : {1e-7f, 0.0f, -1.0f}) {
        r.draw({{a, b, {d.x(), d.y(), z}}, {{0, 1, 2}}}, c);
        EXPECT_EQ(covered(r), 0u) << z;
        r.draw({{-a, -b, {d.x(), d.y(), z}}, {{0, 1, 2}, {0, 2, 1}}}, c);
        EXPECT_EQ(covered(r), 0u) << z;
    }
    r.draw({{a, b, d}, {{0, 1, 1}, {2, 2, 2}}}, c);
    EXPECT_EQ(covered(r), 0u);
    // Collinear in space, exactly so: rounded in the image they are slivers of some 1e-4 pixels, of which a few in a
    // thousand would reach a pixel centre.
    Rng rng(31);
    Mesh slivers;
    const auto place = [&](double low, double high) {
        return std::round(rng.uniform(float(low), float(high)) * 1024) / 1024;
    };
    for (uint32_t k = 0; k < 6000; k += 3) {
        const Vec3f p = Vec3d(place(-1, 1), place(-1, 1), place(2, 3)).cast<float>();
        const Vec3f q = Vec3d(place(-1, 1), place(-1, 1), place(2, 3)).cast<float>();
        slivers.positions.insert(slivers.positions.end(), {p, q, 0.5f * (p + q)});
        slivers.triangles.push_back({k, k + 1, k + 2});
        slivers.triangles.push_back({k, k + 2, k + 1});
    }
    r.draw(slivers, straight_camera(128));
    EXPECT_EQ(covered(r), 0u);
}

TEST(Raster, CoversTheImageWithATriangleFarBeyondIt) {
    const Camera c = straight_camera(16);
    const Mesh mesh{{at_pixel(c, -1e7, 2e7), at_pixel(c, 2e7, 2e7), at_pixel(c, -1e7, -3e7)}, {{0, 1, 2}}};
    Rasterizer r;
    r.draw(mesh, c);
    EXPECT_EQ(covered(r), 256u);
    for (const float iz : r.inverse_depth()) EXPECT_NEAR(iz, 1, 1e-6);
}

TEST(Raster, RemembersNothingBetweenCalls) {
    const Mesh mesh = ball(5);
    const Camera small = Camera::look_at({0, 1, 4}, {0, 0, 0}, {0, 1, 0}, 0.6, 40, 30);
    const Camera large = Camera::look_at({3, 1, 1}, {0, 0, 0}, {0, 1, 0}, 0.6, 90, 80);
    Rasterizer once, again;
    once.draw(mesh, small);
    again.draw(mesh, large);
    again.draw(mesh, small);
    ASSERT_EQ(once.pixels().size(), again.pixels().size());
    EXPECT_EQ(once.inverse_depth(), again.inverse_depth());
    for (size_t k = 0; k < once.pixels().size(); ++k) {
        EXPECT_EQ(once.pixels()[k].triangle, again.pixels()[k].triangle);
        EXPECT_EQ(once.pixels()[k].b1, again.pixels()[k].b1);
    }
}

/// The nearest hit by solving a 3 x 3 system for every triangle.
RayHit brute_force(const Mesh& mesh, const Vec3d& origin, const Vec3d& d, bool front_only) {
    RayHit best;
    for (uint32_t t = 0; t < mesh.triangle_count(); ++t) {
        const Vec3d p0 = mesh.positions[mesh.triangles[t][0]].cast<double>();
        const Vec3d e1 = mesh.positions[mesh.triangles[t][1]].cast<double>() - p0;
        const Vec3d e2 = mesh.positions[mesh.triangles[t][2]].cast<double>() - p0;
        const auto det = [](const Vec3d& a, const Vec3d& b, const Vec3d& c) { return a.dot(b.cross(c)); };
        const double whole = det(e1, e2, -d);  // origin + t d = p0 + b1 e1 + b2 e2
        if (whole == 0 || (front_only && whole < 0)) continue;
        const Vec3d s = origin - p0;
        const double b1 = det(s, e2, -d) / whole, b2 = det(e1, s, -d) / whole, along = det(e1, e2, s) / whole;
        if (b1 >= 0 && b2 >= 0 && b1 + b2 <= 1 && along > 0 && along < best.t) best = {along, t, b1, b2};
    }
    return best;
}

TEST(RayCaster, FindsWhatASearchOfAllTrianglesFinds) {
    const Mesh mesh = ball(9, 0.4f);
    const RayCaster rays(mesh);
    Rng rng(29);
    int hits = 0;
    for (int k = 0; k < 4000; ++k) {
        const Vec3d origin(rng.uniform(-2, 2), rng.uniform(-2, 2), rng.uniform(-2, 2));
        const Vec3d d = Vec3d(rng.uniform(-1.5, 1.5), rng.uniform(-1.5, 1.5), rng.uniform(-1.5, 1.5)) - origin;
        const RayHit expected = brute_force(mesh, origin, d, k % 2);
        const RayHit hit = rays.closest(origin, d, INFINITY, k % 2 ? RayCaster::Faces::front : RayCaster::Faces::both);
        ASSERT_EQ(hit.triangle, expected.triangle) << k;
        if (!hit.hit()) continue;
        ++hits;
        ASSERT_NEAR(hit.t, expected.t, 1e-9 * expected.t);
        ASSERT_NEAR(hit.b1, expected.b1, 1e-9);
        ASSERT_NEAR(hit.b2, expected.b2, 1e-9);
        if (k % 2) continue;
        EXPECT_TRUE(rays.occluded(origin, d));
        EXPECT_TRUE(rays.occluded(origin, d, hit.t * 1.0001));
        EXPECT_FALSE(rays.occluded(origin, d, hit.t * 0.9999));
        EXPECT_FALSE(rays.closest(origin, d, hit.t * 0.9999).hit());
    }
    EXPECT_GT(hits, 1000);
    EXPECT_LT(hits, 3900);  // rays that miss are wanted, too
}

TEST(RayCaster, MeetsAxisAlignedGeometryAlongTheAxes) {
    // Octant boundaries lie in the planes of the axes, box faces pass through the rays.
    const RayCaster rays(ball(8));
    for (int axis = 0; axis < 3; ++axis)
        for (const double sign : {1.0, -1.0})
            for (const double aside : {0.0, 0.25}) {
                Vec3d origin = Vec3d::Zero();
                origin[axis] = 3 * sign;
                origin[(axis + 1) % 3] = aside;
                Vec3d d = Vec3d::Zero();
                d[axis] = -sign;
                const RayHit hit = rays.closest(origin, d);
                ASSERT_TRUE(hit.hit()) << axis << " " << sign << " " << aside;
                EXPECT_NEAR(hit.t, 3 - std::sqrt(1 - aside * aside), 0.02);  // facets lie that much within the sphere
            }
    // A flat square: its boxes have no thickness.
    const RayCaster flat(Mesh{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}});
    EXPECT_TRUE(flat.occluded({0.5, 0.25, 1}, {0, 0, -1}));
    EXPECT_FALSE(flat.occluded({1.5, 0.25, 1}, {0, 0, -1}));
    EXPECT_FALSE(flat.occluded({0.5, 0.25, 1}, {0, 0, 1}));
    EXPECT_FALSE(RayCaster(Mesh{}).occluded({0, 0, 0}, {0, 0, 1}));
}

}  // namespace
}  // namespace radiafit

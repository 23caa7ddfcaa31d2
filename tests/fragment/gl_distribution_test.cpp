// Distribution by OpenGL: the rule of Section 5.1.1, and agreement with the CPU rasterizer and between contexts.
#include <gtest/gtest.h>

#include <set>

#include "context_kinds.h"
#include "fragment/gl_distributor.h"
#include "samples/raster_distributor.h"
#include "shared_context.h"

namespace radiafit {
namespace {

constexpr int width = 300, height = 260, cameras = 6;

TEST(GlDistribution, KeepsTheRule) {
    SharedContext::use();
    const Mesh mesh = awkward_mesh(3);
    for (int side : {3, 8}) {
        const TriangleAtlas atlas(mesh, side);
        GlDistributor distributor(atlas);
        Distribution d;
        for (int i = 0; i < cameras; ++i) {
            const Camera camera = orbit_camera(i, cameras, width, height);
            const TargetImage image = noise_image(width, height, unsigned(i));
            distributor.distribute(camera, image, d);
            ASSERT_EQ(d.texel_pixel.size(), atlas.texel_count());
            EXPECT_GT(d.covered_pixels, 10000u);
            std::set<uint32_t> taken;
            for (uint32_t texel = 0; texel < atlas.texel_count(); ++texel) {
                const uint32_t pixel = d.texel_pixel[texel];
                if (pixel == no_pixel) continue;
                ASSERT_LT(pixel, uint32_t(width * height));
                EXPECT_TRUE(taken.insert(pixel).second) << "pixel " << pixel << " feeds two texels";
                EXPECT_TRUE(atlas.usable(texel));
                EXPECT_TRUE(image.masked_in(pixel));
                // The texel's centre, projected in double, is in that pixel but for float rounding at its rim.
                const Vec3d at = camera.project(atlas.position(texel).cast<double>());
                EXPECT_GT(at.z(), 0);
                EXPECT_NEAR(at.x(), pixel % width + 0.5, 0.5 + 1e-3);
                EXPECT_NEAR(at.y(), pixel / width + 0.5, 0.5 + 1e-3);
            }
            EXPECT_EQ(taken.size(), d.kept_pixels);
            EXPECT_LE(d.kept_pixels, d.covered_pixels);
        }
    }
}

TEST(GlDistribution, AgreesWithTheCpuRasterizer) {
    SharedContext::use();
    const Mesh mesh = awkward_mesh(3);
    const TriangleAtlas atlas(mesh, 8);
    GlDistributor by_gl(atlas);
    RasterDistributor by_cpu(atlas);
    Distribution a, b;
    for (int i = 0; i < cameras; ++i) {
        const Camera camera = orbit_camera(i, cameras, width, height);
        const TargetImage image = noise_image(width, height, unsigned(i));
        by_gl.distribute(camera, image, a);
        by_cpu.distribute(camera, image, b);
        size_t differing = 0;
        for (uint32_t texel = 0; texel < atlas.texel_count(); ++texel)
            differing += a.texel_pixel[texel] != b.texel_pixel[texel];
        // Pixel centres within OpenGL's 1/256 pixel of a triangle's edge, and texel centres within float rounding of a
        // pixel's, may go either way: measured about 0.5% of the samples.
        EXPECT_LT(double(differing), 0.015 * a.kept_pixels) << "camera " << i;
        EXPECT_NEAR(double(a.covered_pixels), double(b.covered_pixels), 0.002 * b.covered_pixels);
    }
}

TEST(GlDistribution, EglAndOsMesaGiveTheSameBits) {
    if (!has_osmesa()) GTEST_SKIP() << "no OSMesa here";
    const Mesh mesh = awkward_mesh(2);
    const TriangleAtlas atlas(mesh, 8);
    std::vector<std::vector<uint32_t>> results;
    for (ContextKind kind : {ContextKind::egl, ContextKind::osmesa, ContextKind::egl}) {
        const auto context = make_context(kind);
        if (kind == ContextKind::egl && !context->software()) GTEST_SKIP() << "EGL runs on " << context->renderer();
        GlDistributor distributor(atlas);
        Distribution d;
        results.emplace_back();
        for (int i = 0; i < cameras; ++i) {
            distributor.distribute(orbit_camera(i, cameras, width, height), noise_image(width, height, unsigned(i)), d);
            results.back().insert(results.back().end(), d.texel_pixel.begin(), d.texel_pixel.end());
        }
    }
    EXPECT_EQ(results[0], results[1]);
    EXPECT_EQ(results[0], results[2]);
}

TEST(GlDistribution, ImagesMayGrowAndDeepen) {
    const auto context = make_context(second_kind());
    const Mesh mesh = bumpy_sphere(1);
    const TriangleAtlas atlas(mesh, 8);
    GlDistributor one(atlas);
    Distribution a, b;
    for (const auto& [w, h] : {std::array{90, 80}, {200, 60}, {60, 200}}) {
        TargetImage image = noise_image(w, h, 1);
        const Camera camera = orbit_camera(1, 4, w, h);
        GlDistributor fresh(atlas);
        one.distribute(camera, image, a);
        fresh.distribute(camera, image, b);
        EXPECT_EQ(a.texel_pixel, b.texel_pixel);
        image.bits = 16;
        image.rgba16.resize(image.rgba8.size());
        for (size_t i = 0; i < image.rgba8.size(); ++i) image.rgba16[i] = uint16_t(257 * image.rgba8[i]);
        one.distribute(camera, image, a);
        EXPECT_EQ(a.texel_pixel, b.texel_pixel);
        EXPECT_GT(a.kept_pixels, 100u);
    }
}

}  // namespace
}  // namespace radiafit

#include "eval/safe_relighting.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/rng.h"
#include "scenes.h"

namespace radiafit::testing {
namespace {

Light lamp(double polar_degrees, double azimuth_degrees) {
    const double a = polar_degrees * M_PI / 180, b = azimuth_degrees * M_PI / 180;
    return {Light::Kind::distant, {std::sin(a) * std::cos(b), std::sin(a) * std::sin(b), std::cos(a)}, Vec3d::Ones()};
}

/// A sheet under twelve lamps within 35 degrees of its normal, and a fit that has gone astray: any Lafortune parameters
/// within their bounds, a few not numbers.
class Relighting : public ::testing::Test {
protected:
    Relighting() : dataset(sheet_dataset(troubled_mesh(3, 4, 5), 12, 32, 3)), atlas(dataset.mesh, 4) {
        for (size_t i = 0; i < dataset.views.size(); ++i) {
            dataset.views[i].light = lamp(i % 2 ? 35 : 20, 30.0 * double(i));
            training.push_back(uint32_t(i));
        }
        fit.options.model = find_texel_model("lafortune");
        fit.samples.assign(atlas.texel_count(), 12);
        Rng rng(1);
        for (uint32_t t = 0; t < atlas.texel_count(); ++t)
            for (int i = 0; i < fit.options.model->parameters; ++i) {
                const auto [low, high] = fit.options.model->bounds[size_t(i)];
                fit.parameters.push_back(t % 50 == 7 ? NAN : rng.uniform(float(low), float(high)));
            }
        for (uint32_t tile = 0; tile < atlas.tile_count(); ++tile)
            for (const auto& [b1, b2] : {std::pair(0.1f, 0.1f), std::pair(0.7f, 0.1f), std::pair(0.1f, 0.7f)})
                if (!atlas.degenerate(tile)) {
                    RasterPixel& pixel = pixels.emplace_back();
                    pixel.triangle = tile;
                    pixel.b1 = b1;
                    pixel.b2 = b2;
                }
    }
    View relit(const Light& light) const {
        View view = dataset.views[0];
        view.light = light;
        return view;
    }
    /// A fit within its images: dull lobes about the mirror direction.
    void tame() {
        const size_t n = size_t(fit.options.model->parameters);
        for (size_t i = 0; i < fit.parameters.size(); i += n) {
            for (size_t k = 0; k < 6; ++k) fit.parameters[i + k] = 0.05f + 0.03f * float((i + k) % 11);
            fit.parameters[i + 6] = -1;
            fit.parameters[i + 7] = 1;
            fit.parameters[i + 8] = 1.5f;
        }
    }
    std::vector<float> plain(const View& view) const {
        std::vector<float> rgb;
        ReflectanceRenderer(atlas, fit).shade(view, pixels, rgb);
        return rgb;
    }
    std::vector<float> safe(const View& view) const {
        std::vector<float> rgb;
        SafeRelighting(dataset, training, atlas, fit).shade(view, pixels, rgb);
        return rgb;
    }

    Dataset dataset;
    TriangleAtlas atlas;
    ReflectanceFit fit;
    std::vector<uint32_t> training;
    std::vector<RasterPixel> pixels;
};

// The property that relighting is asked for: from any lamp of the hemisphere, nothing below 0, above twice what a
// training image can hold, or not a number; and the fit alone does not have it.
TEST_F(Relighting, StaysWithinWhatImagesCanHoldFromAnyLamp) {
    float plain_most = 0, safe_most = 0;
    const SafeRelighting renderer(dataset, training, atlas, fit);
    std::vector<float> rgb;
    for (int polar = 0; polar <= 90; polar += 10)
        for (int azimuth = 0; azimuth < 360; azimuth += 10) {
            const View view = relit(lamp(polar, azimuth));
            renderer.shade(view, pixels, rgb);
            for (const float x : rgb) {
                ASSERT_TRUE(std::isfinite(x));
                ASSERT_GE(x, 0);
                safe_most = std::max(safe_most, x);
            }
            for (const float x : plain(view)) plain_most = std::max(plain_most, std::isfinite(x) ? x : 0);
        }
    EXPECT_LE(safe_most, 2);
    EXPECT_GT(safe_most, 0.2f);
    EXPECT_GT(plain_most, 2);
}

// Where the fit's values are such as the images hold, nothing is changed amid them.
TEST_F(Relighting, ShowsTheFitAmidItsImages) {
    tame();
    int compared = 0;
    for (const uint32_t v : training) {
        const auto expected = plain(dataset.views[v]), shown = safe(dataset.views[v]);
        for (size_t i = 0; i < shown.size(); ++i, ++compared) ASSERT_FLOAT_EQ(shown[i], expected[i]);
    }
    EXPECT_GT(compared, 100);
}

TEST_F(Relighting, FadesBeyondThemToAColourThatIsLambertian) {
    const SafeRelighting renderer(dataset, training, atlas, fit);
    double last = 2;
    for (int polar = 0; polar < 90; polar += 5) {
        const double share = renderer.share_of_fit(relit(lamp(polar, 0)));
        EXPECT_LE(share, last);
        last = share;
    }
    EXPECT_EQ(renderer.share_of_fit(relit(lamp(10, 80))), 1);
    EXPECT_EQ(last, 0);
    // What goes with the cosine alone is linear in the direction.
    tame();
    const Light one = lamp(70, 0), other = lamp(70, 20);
    const Vec3d sum = one.direction_from(Vec3d::Zero()) + other.direction_from(Vec3d::Zero());
    const Light between{Light::Kind::distant, sum.normalized(), Vec3d::Ones()};
    const auto a = safe(relit(one)), b = safe(relit(other)), c = safe(relit(between));
    int compared = 0;
    for (size_t i = 0; i < a.size(); ++i)
        if (a[i] > 0 && b[i] > 0) {
            EXPECT_NEAR(a[i] + b[i], float(sum.norm()) * c[i], 1e-5f);
            ++compared;
        }
    EXPECT_GT(compared, 50);
}

TEST_F(Relighting, TexelsWithoutSamplesHaveTheMeanColourOfTheOthers) {
    std::fill(fit.samples.begin(), fit.samples.begin() + ptrdiff_t(atlas.texels_per_tile()), 0);
    const auto shown = safe(dataset.views[1]);
    const Vec3f filled = Vec3f::Map(shown.data());
    EXPECT_GT(filled.minCoeff(), 0);
    EXPECT_LT(filled.maxCoeff(), 1);
}

}  // namespace
}  // namespace radiafit::testing

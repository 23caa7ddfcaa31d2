#include "eval/specular_enhancement.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "dataset/grid.h"
#include "eval/texel_pixels.h"

namespace radiafit {
namespace {

/// Waves of a coloured matt surface over a grid of 24 x 16 texels, one of which has no normal.
class Waves : public ::testing::Test {
protected:
    Waves() : grid(Grid::centered(24, 16, 0.1)), atlas(make_atlas(grid)) {
        for (uint32_t t = 0; t < atlas.texel_count(); ++t) {
            const Vec3d at = atlas.position(t).cast<double>();
            normals.push_back(
                Vec3d(0.4 * std::sin(9 * at.x()), 0.3 * std::cos(7 * at.y()), 1).normalized().cast<float>());
        }
        normals[5].setZero();
        view.camera_direction = Vec3d::UnitZ();
        view.light = Light{Light::Kind::distant, Vec3d(0.5, 0.3, 0.8).normalized(), Vec3d(1, 0.9, 0.7)};
    }
    Vec3d matt(uint32_t texel) const {
        const Vec3d at = atlas.position(texel).cast<double>(), albedo(0.7, 0.5, 0.1 + 0.001 * texel);
        const double cosine = normals[texel].cast<double>().dot(view.light->direction_from(at));
        return std::max(0.0, cosine) * albedo.cwiseProduct(view.light->irradiance_at(at));
    }
    Contestant contestant() const {
        return {[this](const View&, const std::vector<RasterPixel>& pixels, std::vector<float>& rgb, int) {
                    for (size_t i = 0; i < pixels.size(); ++i)  // a texel each
                        Vec3f::Map(&rgb[3 * i]) = matt(pixels[i].triangle).cast<float>();
                },
                TargetSpace::linear, [](const View&) { return 0.25; }};
    }
    std::vector<float> shown(const Contestant& by) const {
        std::vector<float> rgb(3 * atlas.texel_count());
        by.shade(view, texel_pixels(atlas), rgb, 0);
        return rgb;
    }
    Vec3d expected(uint32_t texel, const SpecularEnhancement& by) const {
        const Vec3d at = atlas.position(texel).cast<double>(), light = matt(texel);
        const Vec3d half = (view.light->direction_from(at) + view.direction_to_camera(at)).normalized();
        const double cosine = std::max(0.0, normals[texel].cast<double>().dot(half));
        const double luminance = Vec3d(0.2126, 0.7152, 0.0722).dot(light);
        return by.diffuse * light + by.highlight * luminance * std::pow(cosine, by.exponent) * Vec3d::Ones();
    }

    Grid grid;
    GridAtlas atlas;
    std::vector<Vec3f> normals;
    View view;
};

TEST_F(Waves, AreEnhancedByTheFormula) {
    for (const Light::Kind kind : {Light::Kind::distant, Light::Kind::near}) {
        view.light->kind = kind;
        for (const SpecularEnhancement by : {SpecularEnhancement{}, {0, 1, 1}, {1, 0, 75}, {0.5, 2, 300}}) {
            const std::vector<float> rgb = shown(enhanced(contestant(), by, atlas, normals));
            double most = 0;
            for (uint32_t t = 0; t < atlas.texel_count(); ++t) {
                const Vec3d wanted = expected(t, by);
                // a cosine that is off by some roundings is, to such a power, off by so many times more
                const double tolerance = (4 + 4 * by.exponent) * 6e-8 * (0.01 + wanted.maxCoeff());
                EXPECT_LT((Vec3f::Map(&rgb[3 * t]).cast<double>() - wanted).cwiseAbs().maxCoeff(), tolerance) << t;
                most = std::max(most, (wanted - by.diffuse * matt(t)).maxCoeff());
            }
            EXPECT_EQ(most > 0.05, by.highlight > 0);  // some of the waves do shine
            EXPECT_LT((Vec3f::Map(&rgb[15]).cast<double>() - by.diffuse * matt(5)).norm(), 1e-7);  // without a normal
        }
    }
}

TEST_F(Waves, StayAsTheyAreWithoutAnyStrength) {
    EXPECT_EQ(shown(enhanced(contestant(), {1, 0, 75}, atlas, normals)), shown(contestant()));
    EXPECT_NE(shown(enhanced(contestant(), {}, atlas, normals)), shown(contestant()));
    EXPECT_EQ(enhanced(contestant(), {}, atlas, normals).share_of_fit(view), 0.25);
}

TEST_F(Waves, OfStoredValuesOrOtherAtlasesAreRefused) {
    Contestant stored = contestant();
    stored.space = TargetSpace::stored;
    EXPECT_THROW(enhanced(stored, {}, atlas, normals), std::invalid_argument);
    normals.pop_back();
    EXPECT_THROW(enhanced(contestant(), {}, atlas, normals), std::invalid_argument);
}

}  // namespace
}  // namespace radiafit

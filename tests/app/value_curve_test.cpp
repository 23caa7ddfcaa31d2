#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "base/rng.h"
#include "dataset/dataset.h"
#include "dataset/texel_shading.h"
#include "eval/safe_relighting.h"
#include "fitting/family.h"
#include "fitting/fit_options.h"
#include "fitting/solvers/solver.h"
#include "temporary_folder.h"
#include "texel_scene.h"

namespace radiafit {
using namespace fits;
namespace {

constexpr int side = 8, lamps = 24;

/// A plane whose values on a curve are polynomials of the lamp's direction, under lamps of different strengths.
struct PolynomialPlane {
    ValueCurve curve;
    std::vector<float> parameters;  ///< [texels][18]
    Dataset dataset;

    PolynomialPlane(const std::filesystem::path& folder, ValueCurve of_curve) : curve(of_curve) {
        Rng rng(3);
        TexelOptions options;
        options.model = find_texel_model("ptm");
        options.curve = curve;
        for (int t = 0; t < side * side; ++t)
            for (int k = 0; k < 6; ++k)
                for (int c = 0; c < 3; ++c)
                    parameters.push_back(k == 5 ? rng.uniform(0.5f, 0.6f) : rng.uniform(-0.09f, 0.09f));
        Dataset header;
        header.name = "polynomials";
        header.grid = Grid::centered(side, side, 1);
        const auto atlas = texel_atlas(header, 0);
        DatasetWriter writer(folder);
        writer.set_encoding(Encoding::f32_linear);
        for (int i = 0; i < lamps; ++i) {
            View view;
            view.name = std::to_string(i);
            view.camera.width = view.camera.height = side;
            view.camera_direction = Vec3d::UnitZ();
            const auto u = testing::random_direction(rng, 0.2);
            view.light =
                Light{Light::Kind::distant, {u.x, u.y, u.z}, Vec3d(0.7, 1, 1.3) * double(rng.uniform(0.5f, 1))};
            std::vector<float> pixels;
            for (size_t t = 0; t < size_t(side * side); ++t) {
                const auto lit = TexelShading::lit(TexelShading::place(*atlas, uint32_t(t)), view);
                const Vec3f shown = shown_value(options, {&parameters[18 * t], 18}, lit.u, lit.v);
                for (int c = 0; c < 3; ++c) pixels.push_back(shown[c] * float(view.light->intensity[c]));
            }
            writer.add(view, pixels.data(), {});
        }
        writer.finish(header);
        dataset = open_dataset(folder);
    }
};

class ValueCurveFit : public ::testing::Test {
protected:
    const TemporaryFolder folder_;
    const std::filesystem::path root_ = folder_.path();
    static FitRequest request(const char* curve) {
        return FitRequest().set("model", "ptm").set("curve", curve).set("optimizer", "lm");
    }
};

TEST_F(ValueCurveFit, FindsPolynomialsOfValuesOnTheCurve) {
    for (const auto& [name, curve] : value_curves()) {
        const PolynomialPlane plane(root_ / name, curve);
        const ReflectanceFit fit = solve_reflectance(plane.dataset, request(name.c_str())).fit;
        EXPECT_EQ(fit.options.curve, curve);
        for (size_t i = 0; i < plane.parameters.size(); ++i)
            ASSERT_NEAR(fit.parameters[i], plane.parameters[i], 2e-4) << name << " " << i;
    }
}

TEST_F(ValueCurveFit, ShowsTheLightOfItsValues) {
    const PolynomialPlane plane(root_ / "set", ValueCurve::srgb);
    const ReflectanceOutcome solved = solve_reflectance(plane.dataset, request("srgb"));
    const std::vector<uint32_t> training = fitted_views(plane.dataset, solved.fit);
    const SafeRelighting shown(plane.dataset, training, *solved.atlas, solved.fit);
    for (const uint32_t v : training) {
        const View& view = plane.dataset.views[v];
        for (uint32_t t = 0; t < uint32_t(side * side); ++t) {
            const auto lit = TexelShading::lit(TexelShading::place(*solved.atlas, t), view);
            const Vec3f value = shown_value(solved.fit.options, {&plane.parameters[18 * t], 18}, lit.u, lit.v);
            const Vec3f light = value.cwiseProduct(view.light->intensity.cast<float>());
            ASSERT_LT((shown.colour_of(t, view, 1) - light).norm(), 1e-3f) << v << " " << t;
        }
    }
}

TEST_F(ValueCurveFit, StaysWithTheFit) {
    const PolynomialPlane plane(root_ / "set", ValueCurve::root);
    const ReflectanceOutcome solved = solve_reflectance(plane.dataset, request("root"));
    write_fit(root_ / "fit", solved.fit, *solved.atlas);
    EXPECT_EQ(read_reflectance(root_ / "fit").fit.options.curve, ValueCurve::root);
}

/// To the same errors as on the CPU, and nearly to the polynomials themselves, of which conjugate gradients in floats
/// tell the squares apart last.
TEST_F(ValueCurveFit, ComputeShadersFindThem) {
    for (const auto& [name, curve] : value_curves()) {
        const PolynomialPlane plane(root_ / name, curve);
        FitRequest by_cg = request(name.c_str());
        by_cg.set("optimizer", "cg").set("iterations", "600");
        const ReflectanceFit on_cpu = solve_reflectance(plane.dataset, by_cg).fit;
        const ReflectanceFit fit = solve_reflectance(plane.dataset, by_cg.set("engine", "compute")).fit;
        for (size_t i = 0; i < fit.problem_count(); ++i) {
            EXPECT_LT(std::sqrt(2 * fit.error[i] / float(3 * fit.samples[i])), 1e-4f) << name << " " << i;
            EXPECT_NEAR(fit.error[i], on_cpu.error[i], 1e-6f) << name << " " << i;
        }
        for (size_t i = 0; i < plane.parameters.size(); ++i)
            ASSERT_NEAR(fit.parameters[i], plane.parameters[i], 5e-3) << name << " " << i;
    }
}

TEST(ValueCurveOption, IsOfModelsUnderLampsButNotOfFragmentPrograms) {
    FitRequest request = FitRequest().set("model", "ptm");
    EXPECT_EQ(request.value_curve(), ValueCurve::linear);
    EXPECT_EQ(FitRequest().set("model", "lightbasis").value_curve(), ValueCurve::srgb);
    EXPECT_EQ(request.set("curve", "srgb").texel_options().curve, ValueCurve::srgb);
    EXPECT_EQ(request.text("curve"), "srgb");
    EXPECT_NO_THROW(request.check());
    request.set("engine", "fragment");
    EXPECT_THROW(request.check(), UserError);
}

}  // namespace
}  // namespace radiafit

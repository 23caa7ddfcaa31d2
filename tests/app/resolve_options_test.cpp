#include "fitting/resolve_options.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <set>
#include <string>

#include "base/error.h"
#include "mesh_shapes.h"
#include "temporary_folder.h"

namespace radiafit {
using namespace fits;
namespace {

View seen_from(const Vec3d& eye) {
    View view;
    const Vec3d up = std::abs(eye.normalized().z()) < 0.9 ? Vec3d::UnitZ() : Vec3d::UnitX();
    view.camera = Camera::look_at(eye, Vec3d::Zero(), up, 6 / eye.norm(), 400, 300);
    return view;
}

/// The unit ball from far away along the axes.
Dataset ball_from_six_sides() {
    Dataset dataset;
    dataset.mesh = testing::ball(8);
    for (const Vec3d& axis : {Vec3d(1, 0, 0), Vec3d(0, 1, 0), Vec3d(0, 0, 1)})
        for (const double side : {1000, -1000}) dataset.views.push_back(seen_from(side * axis));
    return dataset;
}

/// Images of a flat grid from above, under a lamp each.
Dataset grid_under_lamps(int images) {
    Dataset dataset;
    dataset.grid = Grid::centered(4, 3, 1);
    for (int i = 0; i < images; ++i) {
        View view;
        view.camera.width = 4, view.camera.height = 3;
        view.camera_direction = Vec3d::UnitZ();
        view.light = Light{};
        dataset.views.push_back(view);
    }
    return dataset;
}

struct Settled {
    FitRequest request;
    std::string line;
};
Settled settled(const Dataset& dataset, const FitSetting& options = {}) {
    Settled out;
    std::set<std::string> flags;
    for (const auto& [name, value] : options) {
        out.request.set(name, value);
        flags.insert(find_fit_option(name).first_flag());
    }
    const auto given = [&](const char* flag) { return flags.contains(flag); };
    out.line = resolve_options(given, dataset, out.request);
    return out;
}

TEST(ViewsPerTexel, CountsTrainingViewsThatFaceAPlace) {
    Dataset dataset = ball_from_six_sides();
    EXPECT_EQ(views_per_texel(dataset), 3);  // each octant faces three
    for (size_t v = 2; v < 6; ++v) dataset.views[v].held_out = true;
    EXPECT_EQ(views_per_texel(dataset), 1);
}

TEST(ViewsPerTexel, DoesNotCountViewsInWhichAnotherPartHidesThePlace) {
    Dataset dataset;
    dataset.mesh = testing::ball(12);
    Mesh front = testing::ball(4);
    for (Vec3f& position : front.positions) position *= 1.5f;
    testing::append(dataset.mesh, front, {5, 0, 0});
    // Of the far ball's triangles, nearly all that there are, one half would be seen thrice.
    for (const double x : {1000, 1010, 1020, -1000}) dataset.views.push_back(seen_from({x, 0, 0}));
    EXPECT_EQ(views_per_texel(dataset), 1);
}

TEST(ViewsPerTexel, IsZeroWhereNoCameraLooks) {
    Dataset dataset = ball_from_six_sides();
    for (View& view : dataset.views) view.camera.cx = 1e5;
    EXPECT_EQ(views_per_texel(dataset), 0);
    dataset.views.clear();
    EXPECT_EQ(views_per_texel(dataset), 0);
}

TEST(Settle, LightThatStaysIsFittedByAViewBasisUnlessOptionsAskForMore) {
    const Dataset dataset = ball_from_six_sides();
    const Settled plain = settled(dataset);
    EXPECT_EQ(plain.request.model_name, "viewbasis");
    EXPECT_NE(plain.line.find("--model viewbasis (light that stays, a median of 3 training views"), std::string::npos)
        << plain.line;
    EXPECT_EQ(settled(dataset, {{"rank", "4"}}).request.model_name, "viewbasis");
    EXPECT_EQ(settled(dataset, {{"validation", "4"}, {"space", "linear"}}).request.model_name, "viewbasis");
    for (const auto& [option, value] : FitSetting{{"terms", "2"},
                                                  {"engine", "compute"},
                                                  {"solver", "pca"},
                                                  {"solver", "stream"},
                                                  {"iterations", "3"},
                                                  {"loss", "huber"}}) {
        const Settled other = settled(dataset, {{option, value}});
        EXPECT_EQ(other.request.model_name, "lfm") << option;
        EXPECT_EQ(other.line, "") << option;
    }
    EXPECT_EQ(settled(dataset, {{"lobes", "2"}}).request.model_name, "sg");
    const Settled named = settled(dataset, {{"model", "sg"}});
    EXPECT_EQ(named.request.model_name, "sg");
    EXPECT_EQ(named.line, "");
}

TEST(Settle, LightFieldMapsHaveThreeTermsAndSmootherViewMapsButInPaperMode) {
    const Dataset dataset = ball_from_six_sides();
    const LfmOptions modern = settled(dataset, {{"model", "lfm"}}).request.model, plain;
    EXPECT_EQ(modern.terms, 3);
    EXPECT_EQ(modern.lambda_view, 0.1f);
    EXPECT_EQ(modern.lambda_surface, plain.lambda_surface);
    const LfmOptions paper = settled(dataset, {{"mode", "paper"}}).request.model;
    EXPECT_EQ(paper.terms, plain.terms);
    EXPECT_EQ(paper.lambda_view, plain.lambda_view);
    const LfmOptions given = settled(dataset, {{"terms", "1"}, {"lambda_view", "0.5"}}).request.model;
    EXPECT_EQ(given.terms, 1);
    EXPECT_EQ(given.lambda_view, 0.5f);
    EXPECT_EQ(settled(dataset, {{"solver", "pca"}}).request.model.terms, plain.terms);
}

TEST(Settle, TexelsKnowTheirSurfaceByLevenbergMarquardt) {
    const Dataset dataset = grid_under_lamps(7);
    EXPECT_EQ(settled(dataset).request.prior, PriorKind::surface);
    EXPECT_EQ(settled(dataset, {{"prior", "none"}}).request.prior, PriorKind::none);
    EXPECT_EQ(settled(dataset, {{"model", "ptm"}}).request.prior, PriorKind::surface);
    for (const auto& [option, value] : FitSetting{{"optimizer", "cg"}, {"loss", "huber"}, {"solver", "tinysolver"}})
        EXPECT_EQ(settled(dataset, {{"model", "lafortune"}, {option, value}}).request.prior, PriorKind::none) << option;
    EXPECT_EQ(settled(ball_from_six_sides()).request.prior, PriorKind::none);
}

TEST(Settle, ColoursByViewDirectionAreNotForFragmentPrograms) {
    const auto takes = [&](const FitSetting& setting) {
        FitRequest request;
        for (const auto& [option, value] : setting) request.set(option, value);
        return takes_given(given_by(setting), request);
    };
    EXPECT_TRUE(takes({{"model", "viewbasis"}, {"engine", "compute"}}));
    EXPECT_TRUE(takes({{"model", "viewbasis"}, {"engine", "compute"}, {"device", "1"}}));
    EXPECT_FALSE(takes({{"model", "viewbasis"}, {"device", "1"}}));
    EXPECT_FALSE(takes({{"model", "viewbasis"}, {"engine", "fragment"}}));
    EXPECT_FALSE(takes({{"model", "sg"}, {"engine", "compute"}}));
    EXPECT_THROW(settled(ball_from_six_sides(), {{"model", "viewbasis"}, {"engine", "fragment"}}), UserError);
}

TEST(Settle, InterpolatesColoursByViewAndWeighsInterpolatedSamples) {
    const Dataset dataset = ball_from_six_sides();
    const auto request = [&](FitSetting setting) { return settled(dataset, setting).request; };
    EXPECT_EQ(request({}).surface, SurfaceLookup::linear);  // a view basis
    EXPECT_EQ(request({{"model", "sg"}}).surface, SurfaceLookup::linear);
    EXPECT_EQ(request({{"model", "sg"}, {"surface", "nearest"}}).surface, SurfaceLookup::nearest);
    EXPECT_EQ(request({{"model", "lfm"}}).surface, SurfaceLookup::nearest);
    const auto weights = [&](FitSetting setting) {
        setting.insert(setting.begin(), {{"model", "lfm"}, {"surface", "linear"}});
        return request(setting).model.loss.weights;
    };
    EXPECT_EQ(request({{"model", "lfm"}}).model.loss.weights, SampleWeights::equal);
    EXPECT_EQ(weights({}), SampleWeights::facing);
    EXPECT_EQ(weights({{"weights", "equal"}}), SampleWeights::equal);
    EXPECT_EQ(weights({{"mode", "paper"}}), SampleWeights::equal);
    EXPECT_EQ(weights({{"solver", "als"}}), SampleWeights::equal);  // takes none
}

TEST(Settle, SmallTrianglesHaveFewerTexelsForColoursByView) {
    Dataset dataset = ball_from_six_sides();
    int before = 12;
    for (const int rings : {4, 8, 16, 32, 64}) {
        dataset.mesh = testing::ball(rings);
        for (const char* model : {"viewbasis", "sg"}) {
            const int side = settled(dataset, {{"model", model}}).request.model.surface_side;
            EXPECT_LE(side, before) << model << ", " << rings;
            if (rings == 4) {
                EXPECT_EQ(side, 12) << model;
            }
            if (rings == 64) {
                EXPECT_EQ(side, 3) << model;
            }
            before = side;
            EXPECT_EQ(settled(dataset, {{"model", model}, {"surface_side", "9"}}).request.model.surface_side, 9);
        }
    }
    for (View& view : dataset.views) view.camera.cx = 1e5;  // none sees it
    EXPECT_EQ(settled(dataset, {{"model", "viewbasis"}}).request.model.surface_side, 12);
}

TEST(Settle, FewLampsAreFittedByTheModelForSoMany) {
    EXPECT_EQ(settled(grid_under_lamps(3)).request.model_name, "lambert");
    EXPECT_EQ(settled(grid_under_lamps(4)).request.model_name, "lafortune");
    EXPECT_EQ(settled(grid_under_lamps(7)).request.model_name, "lafortune");
}

/// Images on disk of a grid whose texels reflect, per unit of the lamp's light, so much to its direction.
Dataset photographed(const std::filesystem::path& folder,
                     const std::function<float(int texel, const Vec3d& lamp)>& of) {
    constexpr int width = 24, height = 20, lamps = 32;
    Dataset header;
    header.name = "made";
    header.description = header.source = "a test's";
    header.grid = Grid::centered(width, height, 1);
    DatasetWriter writer(folder);
    writer.set_encoding(Encoding::f32_linear);
    for (int i = 0; i < lamps; ++i) {
        View view;
        view.name = fmt::format("lamp{:02}.exr", i);
        view.camera.width = width, view.camera.height = height;
        view.camera_direction = Vec3d::UnitZ();
        const double angle = 2.4 * i, z = 0.35 + 0.6 * i / lamps, r = std::sqrt(1 - z * z);
        view.light = Light{Light::Kind::distant, Vec3d(r * std::cos(angle), r * std::sin(angle), z), Vec3d::Ones()};
        std::vector<float> pixels;
        for (int t = 0; t < width * height; ++t)
            for (int c = 0; c < 3; ++c) pixels.push_back(of(t, view.light->place) * float(1 + c) / 3);
        writer.add(view, pixels.data(), {});
    }
    writer.finish(header);
    return open_dataset(folder);
}

// A gloss that Lafortune's model has, and shadows that come and go over the surface as no model of reflection has them.
TEST(Settle, LampsAreFittedByTheModelThatPredictsThemBest) {
    const TemporaryFolder folder;
    const Dataset glossy = photographed(folder.path() / "glossy", [](int texel, const Vec3d& lamp) {
        const double diffuse = 0.2 + 0.02 * (texel % 20), half = (lamp + Vec3d::UnitZ()).normalized().z();
        return float(diffuse * lamp.z() + 0.4 * std::pow(half, 60));
    });
    EXPECT_EQ(settled(glossy).request.model_name, "lafortune");
    const Dataset shadowed = photographed(folder.path() / "shadowed", [](int texel, const Vec3d& lamp) {
        const double angle = 0.3 * texel, edge = lamp.x() * std::cos(angle) + lamp.y() * std::sin(angle);
        return float(0.5 * lamp.z() / (1 + std::exp(30 * edge)) + 0.2 / (1 + std::exp(-20 * (edge + 0.5))));
    });
    const Settled chosen = settled(shadowed);
    EXPECT_EQ(chosen.request.model_name, "lightbasis") << chosen.line;
    EXPECT_NE(chosen.line.find("--model lightbasis"), std::string::npos);
    EXPECT_NE(chosen.line.find("--model ptm"), std::string::npos);  // how the others did
    EXPECT_EQ(chosen.request.clip_above, 0);
    EXPECT_NE(settled(shadowed, {{"loss", "huber"}}).request.model_name, "lightbasis");  // which has no robust loss
}

TEST(Settle, SamplesAreLeftOutWhereTheModelIsChosen) {
    const Settled plain = settled(grid_under_lamps(6));
    EXPECT_EQ(plain.request.clip_above, 0.98f);
    EXPECT_EQ(plain.request.shadow_below, 0.1f);
    EXPECT_NE(plain.line.find("--model lafortune --clip-above 0.98 --shadow-below 0.1"), std::string::npos);
    const Settled given = settled(grid_under_lamps(6), {{"clip_above", "0.5"}});
    EXPECT_EQ(given.request.clip_above, 0.5f);
    EXPECT_EQ(given.line.find("--clip-above"), std::string::npos);
    EXPECT_EQ(settled(grid_under_lamps(6), {{"model", "ptm"}}).request.clip_above, 0);
}

TEST(Settle, RefusesWhatMeansNothing) {
    EXPECT_THROW(settled(ball_from_six_sides(), {{"optimizer", "lm"}}), UserError);
    EXPECT_THROW(settled(grid_under_lamps(6), {{"solver", "pca"}}), UserError);
}

}  // namespace
}  // namespace radiafit

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <numeric>

#include "base/parallel.h"
#include "eval/exposure.h"
#include "eval/judge.h"
#include "eval/lfm_renderer.h"
#include "eval/metrics.h"
#include "eval/render.h"
#include "fit_scene.h"
#include "image/exr.h"

namespace radiafit::testing {
namespace {

namespace fs = std::filesystem;

TEST(Metrics, HandComputed) {
    ErrorSums sums;
    for (const double d : {0.1, -0.1, 0.3, 0.0}) sums.add(d);
    // mean |d| = 0.5 / 4; mean d^2 = (0.01 + 0.01 + 0.09) / 4 = 0.0275
    EXPECT_NEAR(sums.ape(), 255 * 0.125, 1e-12);
    EXPECT_NEAR(sums.psnr(), 15.606673, 1e-6);
    // Pooling is over values, not over images' decibels.
    ErrorSums other, pooled = sums;
    other.add(1.0);
    pooled.add(other);
    EXPECT_NEAR(pooled.psnr(), -10 * std::log10(1.11 / 5), 1e-12);
    EXPECT_NEAR(pooled.ape(), 255 * 1.5 / 5, 1e-12);
    EXPECT_EQ(pooled.values, 5u);
}

TEST(Metrics, NothingHidesAFailure) {
    ErrorSums sums;
    EXPECT_TRUE(std::isnan(sums.psnr())) << "no values is no result";
    EXPECT_TRUE(std::isnan(sums.ape()));
    sums.add(0.0);
    EXPECT_EQ(sums.psnr(), std::numeric_limits<double>::infinity());
    for (const double bad : {double(NAN), double(INFINITY), -double(INFINITY)}) {
        ErrorSums with = sums, pooled;
        with.add(bad);
        with.add(0.1);
        pooled.add(with);
        EXPECT_TRUE(std::isnan(pooled.psnr()));
        EXPECT_TRUE(std::isnan(pooled.ape()));
        EXPECT_EQ(pooled.not_finite, 1u);
    }
    EXPECT_TRUE(std::isnan(clamped(INFINITY))) << "an infinite render is not white";
    EXPECT_TRUE(std::isnan(clamped(-INFINITY)));
    EXPECT_EQ(clamped(-0.5f), 0.0f);
    EXPECT_EQ(clamped(1.5f), 1.0f);
}

// Eq. 14 once more in double, pixel by pixel: a ray through the pixel's centre against every front-facing triangle,
// the cell of the tile, the view coordinate of the paper's hemisphere.
class NaiveRenderer {
public:
    NaiveRenderer(const Mesh& mesh, const LightFieldFit& fit) : mesh_(mesh), fit_(fit) {
        const size_t vertices = mesh.vertex_count();
        const size_t m = size_t(fit.options.view_side);
        stride_ = 4 * size_t(fit.options.terms);
        size_t at = 0;
        for (size_t v = 0; v < vertices; ++v) {
            block_.push_back(at);
            ring_.emplace_back();
            for (size_t t = 0; t < mesh.triangles.size(); ++t)
                if (area(t) > 0)
                    for (size_t c = 0; c < 3; ++c)
                        if (mesh.triangles[t][c] == v) ring_[v].push_back(t);
            at += (texels_before(v, mesh.triangles.size()) + m * m) * stride_;
        }
        std::vector<Vec3d> sum(vertices, Vec3d::Zero());
        for (size_t t = 0; t < mesh.triangles.size(); ++t)
            for (const uint32_t v : mesh.triangles[t]) sum[v] += cross(t);
        for (const Vec3d& s : sum) normal_.push_back(s.norm() > 0 ? Vec3d(s.normalized()) : Vec3d::UnitZ());
    }

    // False where nothing is seen, or where the pixel is so near an edge, a cell's border or a depth tie that rounding
    // may resolve_options it either way.
    bool pixel(const Camera& camera, int x, int y, std::array<double, 3>& rgb, bool& seen) const {
        const Vec3d eye = camera.center();
        const Vec3d in_camera((x + 0.5 - camera.cx) / camera.fx, (y + 0.5 - camera.cy) / camera.fy, 1);
        const Vec3d ray = camera.cam_from_world_rotation.transpose() * in_camera;
        double nearest = 1e30, second = 1e30, b1 = 0, b2 = 0;
        size_t triangle = 0;
        bool certain = true;
        for (size_t t = 0; t < mesh_.triangles.size(); ++t) {
            if (!(area(t) > 0) || cross(t).dot(ray) >= 0) continue;
            const Vec3d o = eye - corner(t, 0), e1 = corner(t, 1) - corner(t, 0), e2 = corner(t, 2) - corner(t, 0);
            // o = b1 e1 + b2 e2 - depth ray, by Cramer's rule
            const double determinant = e1.dot(e2.cross(-ray));
            const Vec3d solution(o.dot(e2.cross(-ray)) / determinant, e1.dot(o.cross(-ray)) / determinant,
                                 e1.dot(e2.cross(o)) / determinant);
            const double inside = std::min({solution[0], solution[1], 1 - solution[0] - solution[1]});
            if (solution[2] <= 0) continue;
            if (std::abs(inside) < 1e-4) certain = false;
            if (inside < 0) continue;
            if (solution[2] < nearest) {
                second = nearest;
                nearest = solution[2], triangle = t, b1 = solution[0], b2 = solution[1];
            } else {
                second = std::min(second, solution[2]);
            }
        }
        seen = nearest < 1e30;
        if (!certain || (seen && second - nearest < 1e-4)) return false;
        if (!seen) return true;
        const int n = side(triangle);
        for (const double b : {b1 * n, b2 * n, (b1 + b2) * n})
            if (std::abs(b - std::round(b)) < 1e-3) return false;
        const int i = int(b1 * n), j = int(b2 * n);
        size_t local = 0;
        for (int row = 0; row < j; ++row) local += size_t(n - row);
        local += size_t(i);
        rgb = {0, 0, 0};
        for (size_t c = 0; c < 3; ++c) {
            const size_t v = mesh_.triangles[triangle][c];
            const float* g = fit_.parameters.data() + block_[v] + (texels_before(v, triangle) + local) * stride_;
            for (size_t k = 0; k < size_t(fit_.options.terms); ++k)
                for (size_t channel = 0; channel < 3; ++channel)
                    if (fit_.samples[3 * v + channel] > 0)
                        rgb[channel] += double(g[4 * k + channel]) * view_value(v, eye, k, channel);
        }
        return true;
    }

private:
    Vec3d corner(size_t t, size_t c) const { return mesh_.positions[mesh_.triangles[t][c]].cast<double>(); }
    Vec3d cross(size_t t) const { return (corner(t, 1) - corner(t, 0)).cross(corner(t, 2) - corner(t, 0)); }
    double area(size_t t) const { return cross(t).norm(); }
    int side(size_t t) const { return fit_.options.sides ? (*fit_.options.sides)[t] : fit_.options.surface_side; }
    /// Texels of v's maps that come before that of a triangle.
    size_t texels_before(size_t v, size_t triangle) const {
        size_t texels = 0;
        for (const size_t t : ring_[v]) texels += t < triangle ? size_t(side(t) * (side(t) + 1) / 2) : 0;
        return texels;
    }

    double view_value(size_t v, const Vec3d& eye, size_t term, size_t channel) const {
        const int m = fit_.options.view_side;
        const Vec3d n = normal_[v];
        const Vec3d tangent = (std::abs(n.z()) < 0.9 ? Vec3d::UnitZ() : Vec3d::UnitX()).cross(n).normalized();
        const Vec3d d = (eye - mesh_.positions[v].cast<double>()).normalized();
        double x = tangent.dot(d), y = n.cross(tangent).dot(d);
        if (n.dot(d) < 0) {
            const double rim = std::hypot(x, y);
            x /= rim, y /= rim;
        }
        const double column = std::clamp((x / 2 + 0.5) * m - 0.5, 0.0, m - 1.0);
        const double row = std::clamp((y / 2 + 0.5) * m - 0.5, 0.0, m - 1.0);
        const float* map = fit_.parameters.data() + block_[v] + texels_before(v, mesh_.triangles.size()) * stride_;
        const auto texel = [&](int i, int j) {
            return double(map[size_t(std::min(j, m - 1) * m + std::min(i, m - 1)) * stride_ + 4 * term + channel]);
        };
        if (fit_.options.lookup == ViewLookup::nearest) return texel(int(column + 0.5), int(row + 0.5));
        const int i = int(column), j = int(row);
        const double u = column - i, w = row - j;
        return (1 - w) * ((1 - u) * texel(i, j) + u * texel(i + 1, j)) +
               w * ((1 - u) * texel(i, j + 1) + u * texel(i + 1, j + 1));
    }

    const Mesh& mesh_;
    const LightFieldFit& fit_;
    size_t stride_;
    std::vector<size_t> block_;
    std::vector<std::vector<size_t>> ring_;
    std::vector<Vec3d> normal_;
};

class Renderer : public ::testing::TestWithParam<std::tuple<int, ViewLookup, bool>> {};

TEST_P(Renderer, EqualsANaiveOneInDouble) {
    const auto [terms, lookup, own_sides] = GetParam();
    Dataset dataset = sheet_dataset(troubled_mesh(3, 7, 11), 4, 60, 12);
    LightFieldFit fit = random_fit(dataset, terms, lookup, 13, own_sides);
    for (size_t c = 0; c < 3; ++c) fit.samples[3 * 5 + c] = 0;  // vertex 5 was never seen: black
    fit.samples[3 * 6 + 1] = 0;                                 // vertex 6 in its green only
    const NaiveRenderer naive(dataset.mesh, fit);
    LfmRenderer renderer(dataset.mesh, fit);
    Rasterizer rasterizer;
    std::vector<float> rgb;
    size_t compared = 0, left_out = 0;
    for (const View& view : dataset.views) {
        rasterizer.draw(dataset.mesh, view.camera);
        renderer.shade(view.camera, rasterizer.pixels(), rgb);
        for (int y = 0; y < 60; ++y)
            for (int x = 0; x < 60; ++x) {
                std::array<double, 3> expected;
                bool seen = false;
                const size_t i = size_t(y * 60 + x);
                if (!naive.pixel(view.camera, x, y, expected, seen)) {
                    ++left_out;
                    continue;
                }
                ASSERT_EQ(rasterizer.pixels()[i].triangle != no_triangle, seen) << x << " " << y;
                compared += seen;
                // Values up to 3 K 0.36; a float sum of 3 K products of rounded look-ups stays within 1e-5.
                for (size_t c = 0; c < 3; ++c)
                    ASSERT_NEAR(rgb[3 * i + c], seen ? expected[c] : 0.0, 1e-5) << x << " " << y << " of " << view.name;
            }
    }
    EXPECT_GT(compared, 1000u);
    EXPECT_LT(left_out, compared / 10);
}

INSTANTIATE_TEST_SUITE_P(TermsAndLookups, Renderer,
                         ::testing::Combine(::testing::Values(1, 2),
                                            ::testing::Values(ViewLookup::bilinear, ViewLookup::nearest),
                                            ::testing::Bool()));

// Maps that hold barycentric weights times a colour of each vertex, seen by view maps of 1, are a colour that is linear
// over each triangle: interpolated maps show it between the outermost centres as it is, and within what it changes by
// over a texel elsewhere.
TEST(Interpolated, ShowsWhatIsLinearOnTheSurface) {
    Dataset dataset = sheet_dataset(troubled_mesh(3, 7, 11), 4, 60, 12);
    for (const bool own_sides : {false, true}) {
        LightFieldFit fit = random_fit(dataset, 1, ViewLookup::bilinear, 13, own_sides);
        const VertexRings rings(dataset.mesh);
        const TriangleAtlas atlas = surface_atlas(dataset.mesh, fit.options);
        const LfmLayout layout(rings, atlas, fit.options.view_side, 1);
        std::fill(fit.parameters.begin(), fit.parameters.end(), 1.0f);
        const auto brightness = [&](uint32_t v) { return dataset.mesh.positions[v].x(); };
        for (size_t v = 0; v < layout.problem_count(); ++v) {
            size_t at = layout.offset(v);
            for (const Corner& corner : rings.ring(v))
                for (uint32_t local = 0; local < atlas.tile(corner.triangle).texels(); ++local, at += 4)
                    for (size_t c = 0; c < 3; ++c)
                        fit.parameters[at + c] =
                            atlas.tile(corner.triangle).barycentric(local)[corner.corner] * brightness(uint32_t(v));
        }
        double error[2] = {};
        for (const SurfaceLookup lookup : {SurfaceLookup::nearest, SurfaceLookup::linear}) {
            fit.surface = lookup;
            LfmRenderer renderer(dataset.mesh, fit);
            Rasterizer rasterizer;
            std::vector<float> rgb;
            size_t inside = 0;
            for (const View& view : dataset.views) {
                rasterizer.draw(dataset.mesh, view.camera);
                renderer.shade(view.camera, rasterizer.pixels(), rgb);
                for (size_t i = 0; i < rasterizer.pixels().size(); ++i) {
                    const RasterPixel& pixel = rasterizer.pixels()[i];
                    if (pixel.triangle == no_triangle) continue;
                    const auto& corners = dataset.mesh.triangles[pixel.triangle];
                    const float b[3] = {1 - pixel.b1 - pixel.b2, pixel.b1, pixel.b2};
                    float expected = 0, low = 1e9f, high = -1e9f;
                    for (size_t k = 0; k < 3; ++k) {
                        expected += b[k] * brightness(corners[k]);
                        low = std::min(low, brightness(corners[k]));
                        high = std::max(high, brightness(corners[k]));
                    }
                    const float off = std::abs(rgb[3 * i] - expected), texel = 1 / float(atlas.side(pixel.triangle));
                    error[size_t(lookup)] += off;
                    if (lookup == SurfaceLookup::nearest) continue;
                    const bool between_centres = std::ranges::all_of(b, [&](float w) { return w > 0.5f * texel; });
                    inside += between_centres;
                    if (!between_centres && own_sides) continue;  // a neighbour's texels may be larger
                    ASSERT_LT(off, between_centres ? 1e-5f : 2 * texel * (high - low)) << i;
                }
            }
            EXPECT_EQ(inside > 300, lookup == SurfaceLookup::linear);
        }
        EXPECT_LT(error[1], 0.5 * error[0]);
    }
}

TEST(Unfitted, IsBlackWhateverItsParametersAre) {
    const Dataset dataset = sheet_dataset(troubled_mesh(3, 7, 11), 1, 60, 12);
    LightFieldFit fit = random_fit(dataset, 1, ViewLookup::bilinear, 13);
    const auto brightest = [&] {
        const LightImage image = render(contestant_of(fit, dataset.mesh), dataset, dataset.views[0]);
        return *std::max_element(image.rgb.begin(), image.rgb.end());
    };
    EXPECT_GT(brightest(), 0.1f);
    LightFieldFit kept = fit;
    std::fill(fit.samples.begin(), fit.samples.end(), 0u);
    EXPECT_EQ(brightest(), 0.0f);
    fit = kept;
    std::fill(fit.status.begin(), fit.status.end(), Status::no_samples);
    EXPECT_EQ(brightest(), 0.0f);
}

// ---- the judge, on known images ----

Dataset gray_dataset(const fs::path& folder, uint8_t value, bool masks = false) {
    return write_dataset(
        folder, sheet_dataset(troubled_mesh(3, 7, 1), 5, 48, 2), [=](size_t, int, int, int) { return value; }, masks);
}

const JudgeOptions at_centres{.pixel_points = 1};

/// By the points' places in the list: of pixels, where they are asked for at their centres.
Contestant painter(const std::function<float(size_t pixel, size_t channel)>& color,
                   TargetSpace space = TargetSpace::stored) {
    return {[color](const View&, const std::vector<RasterPixel>& pixels, std::vector<float>& rgb, int) {
                rgb.resize(3 * pixels.size());
                for (size_t i = 0; i < rgb.size(); ++i) rgb[i] = color(i / 3, i % 3);
            },
            space};
}

TEST(Judge, ConstantDifferenceOnTheForegroundOnly) {
    const TemporaryFolder folder;
    const Dataset dataset = gray_dataset(folder.path() / "data", 102, true);  // 102 / 255 = 0.4
    const JudgeResult result =
        judge(painter([](size_t, size_t c) { return c == 0 ? 0.5f : 0.4f; }), dataset, Split::train);
    EXPECT_EQ(result.images.size(), 4u);
    EXPECT_NEAR(result.ape(), 255 * 0.1 / 3, 1e-5);
    EXPECT_NEAR(result.psnr(), -10 * std::log10(0.01 / 3), 1e-4);
    // In linear light the same pair is decode(0.5) - decode(0.4) = 0.21404 - 0.13287 apart.
    const double linear = srgb_decode(0.5) - srgb_decode(0.4);
    EXPECT_NEAR(result.linear.ape(), 255 * linear / 3, 1e-4);
    EXPECT_NEAR(result.linear.psnr(), -10 * std::log10(linear * linear / 3), 1e-3);

    // Foreground: the mask of fit_scene.h where the rasterizer sees the mesh.
    Rasterizer rasterizer;
    uint64_t expected = 0, missing = 0;
    const std::vector<uint32_t> views = dataset.split(false);
    for (size_t v = 0; v < views.size(); ++v) {
        rasterizer.draw(dataset.mesh, dataset.views[views[v]].camera);
        uint64_t pixels = 0;
        for (int i = 0; i < 48 * 48; ++i) {
            const bool mesh = rasterizer.pixels()[size_t(i)].triangle != no_triangle;
            const bool mask = (i % 48 / 5 + i / 48 / 7) % 4 != 0;
            pixels += mesh && mask;
            missing += !mesh && mask;
        }
        EXPECT_EQ(result.images[v].pixels, pixels);
        expected += pixels;
    }
    EXPECT_EQ(result.stored.values, 3 * expected);

    // Mask without mesh, black in a render.
    EXPECT_GT(missing, 0u);
    EXPECT_EQ(result.missing.values, 3 * missing);
    EXPECT_NEAR(result.missing.ape(), 102, 1e-4);
    EXPECT_DOUBLE_EQ(result.missing_share(), double(missing) / double(missing + expected));
    const Dataset unmasked = gray_dataset(folder.path() / "unmasked", 102);
    EXPECT_EQ(judge(painter([](size_t, size_t) { return 0.4f; }), unmasked, Split::train).missing.values, 0u);

    // What a contestant paints where no mesh is seen changes nothing.
    const Contestant loud{[](const View&, const std::vector<RasterPixel>& pixels, std::vector<float>& rgb, int) {
                              rgb.assign(3 * pixels.size(), 0.4f);
                              for (size_t i = 0; i < pixels.size(); ++i)
                                  if (pixels[i].triangle == no_triangle) rgb[3 * i] = NAN;
                          },
                          TargetSpace::stored};
    EXPECT_LT(judge(loud, dataset, Split::train).ape(), 1e-5);
    const JudgedView view = ViewJudge(dataset).compare(loud, 0);
    const size_t first = size_t(std::find(view.foreground.begin(), view.foreground.end(), 1) - view.foreground.begin());
    const size_t background =
        size_t(std::find(view.foreground.begin(), view.foreground.end(), 0) - view.foreground.begin());
    EXPECT_EQ(view.render[3 * background], 0.0f);
    EXPECT_EQ(view.render[3 * first], 0.4f);
}

TEST(Judge, RendersAreClampedAndANaNIsAFailure) {
    const TemporaryFolder folder;
    const Dataset dataset = gray_dataset(folder.path() / "data", 255);
    EXPECT_EQ(judge(painter([](size_t, size_t) { return 7.0f; }), dataset, Split::test).ape(), 0.0);
    EXPECT_EQ(judge(painter([](size_t, size_t) { return -7.0f; }), dataset, Split::test).ape(), 255.0);

    const JudgedView view =
        ViewJudge(dataset).compare(painter([](size_t, size_t) { return 1.0f; }), dataset.split(true)[0]);
    const size_t pixel = size_t(std::find(view.foreground.begin(), view.foreground.end(), 1) - view.foreground.begin());
    for (const float bad : {NAN, INFINITY, -INFINITY}) {
        const JudgeResult result = judge(painter([=](size_t p, size_t c) { return p == pixel && c == 1 ? bad : 1.0f; }),
                                         dataset, Split::test, at_centres);
        EXPECT_TRUE(std::isnan(result.psnr()));
        EXPECT_TRUE(std::isnan(result.linear.ape()));
        EXPECT_GE(result.stored.not_finite, 1u);
        EXPECT_NE(judge_json(result).find("\"psnr\": null"), std::string::npos);
    }
}

TEST(Judge, LinearContestantsAreEncoded) {
    const TemporaryFolder folder;
    const Dataset dataset = gray_dataset(folder.path() / "data", 102);
    const auto light = float(srgb_decode(0.4));
    const auto result =
        judge(painter([=](size_t, size_t) { return light; }, TargetSpace::linear), dataset, Split::test);
    EXPECT_LT(result.ape(), 1e-4);  // float of a decoded value
}

TEST(Judge, TheSameForAnyNumberOfThreads) {
    const TemporaryFolder folder;
    const Dataset dataset = noise_dataset(folder.path() / "data", true);
    const LightFieldFit fit = random_fit(dataset, 2, ViewLookup::bilinear, 3);
    set_thread_count(1);
    const std::string one = judge_json(judge(contestant_of(fit, dataset.mesh), dataset, Split::train));
    set_thread_count(3);
    const std::string three = judge_json(judge(contestant_of(fit, dataset.mesh), dataset, Split::train));
    set_thread_count(0);
    EXPECT_EQ(one, three);
}

TEST(Judge, UserErrors) {
    const TemporaryFolder folder;
    Dataset dataset = gray_dataset(folder.path() / "data", 102);
    const Contestant gray = painter([](size_t, size_t) { return 0.4f; });
    Dataset none = dataset;
    for (View& view : none.views) view.held_out = false;
    EXPECT_NE(user_error([&] { judge(gray, none, Split::test); }).find("train"), std::string::npos);
    Dataset away = dataset;
    for (View& view : away.views) view.camera.cx += 1e6;
    EXPECT_NE(user_error([&] { judge(gray, away, Split::test); }).find("sees the mesh"), std::string::npos);
    EXPECT_NE(user_error([&] { ViewJudge(dataset).compare(gray, 99); }).find("99"), std::string::npos);
}

TEST(Judge, JsonHoldsTheFigures) {
    const TemporaryFolder folder;
    const Dataset dataset = gray_dataset(folder.path() / "data", 102);
    const JudgeResult result = judge(painter([](size_t, size_t) { return 0.5f; }), dataset, Split::test);
    const JudgeResult baseline = judge(painter([](size_t, size_t) { return 0.6f; }), dataset, Split::test);
    const auto json = nlohmann::json::parse(judge_json(result, &baseline));
    EXPECT_EQ(json.at("split"), "test");
    EXPECT_EQ(json.at("images"), 1);
    EXPECT_NEAR(json.at("ape").get<double>(), 25.5, 1e-4);
    EXPECT_NEAR(json.at("psnr").get<double>(), 20.0, 1e-4);
    EXPECT_NEAR(json.at("baseline").at("psnr").get<double>(), 20 - 20 * std::log10(2.0), 1e-4);
    EXPECT_TRUE(json.contains("psnr_linear") && json.contains("ape_linear"));
    EXPECT_EQ(json.at("per_image").at(0).at("name"), "view2");
    EXPECT_EQ(json.at("per_image").at(0).at("gain"), 1.0);
}

// ---- exposure ----

// A scene of known light, photographed with exposures 1 / gain. A contestant that knows the light exactly must be told
// so, in training by the dataset's gains, on held-out views by the judge's own search.
class Exposure : public ::testing::Test {
protected:
    static constexpr std::array<double, 5> gains = {0.8, 1.0, 1.7, 1.25, 1.0};
    static double light(size_t pixel, size_t channel) {
        return 0.02 + 0.5 * random_uniform(4, 3 * pixel + channel);  // at exposure 1.25 some of it is clipped
    }
    Dataset make(const fs::path& folder, double held_out_gain_in_dataset) {
        Dataset header = sheet_dataset(troubled_mesh(3, 7, 1), 5, 48, 2);
        for (size_t i = 0; i < 5; ++i) header.views[i].gain = i == 2 ? held_out_gain_in_dataset : gains[i];
        return write_dataset(folder, header, [](size_t view, int x, int y, int c) {
            const double stored = srgb_encode(2.2 * light(size_t(y * 48 + x), size_t(c)) / gains[view]);
            return uint8_t(std::lround(255 * std::min(1.0, stored)));
        });
    }
    static Contestant oracle(TargetSpace space, double scale = 1) {
        return painter(
            [=](size_t p, size_t c) {
                const double value = scale * 2.2 * light(p, c);
                return float(space == TargetSpace::linear ? value : srgb_encode(value));
            },
            space);
    }
};

TEST_F(Exposure, TrainingViewsUseTheDatasetsGains) {
    const TemporaryFolder folder;
    const Dataset dataset = make(folder.path() / "data", 1);
    for (const TargetSpace space : {TargetSpace::stored, TargetSpace::linear}) {
        const JudgeResult result = judge(oracle(space), dataset, Split::train, at_centres);
        // Only rounding to bytes is left: uniform within +- 1/2 of 1/255, a PSNR of 58.9 dB or (clipped) better.
        EXPECT_GT(result.psnr(), 58.5);
        EXPECT_LT(result.ape(), 0.26);
        EXPECT_EQ(result.images[2].gain, 1.25);
        // A contestant with the wrong exposure is not forgiven in training.
        EXPECT_LT(judge(oracle(space, 1.3), dataset, Split::train, at_centres).psnr(), 30);
    }
}

TEST_F(Exposure, HeldOutGainIsRecovered) {
    const TemporaryFolder folder;
    const Dataset dataset = make(folder.path() / "data", 1);
    for (const TargetSpace space : {TargetSpace::stored, TargetSpace::linear})
        for (const double scale : {0.3, 1.0, 2.5}) {  // alike for every contestant, whatever its own exposure
            const JudgeResult result = judge(oracle(space, scale), dataset, Split::test, at_centres);
            EXPECT_NEAR(result.images[0].gain[0], 1.7 * scale, 1e-3 * scale);  // bytes of 7,000 values: 1e-4 or better
            EXPECT_GT(result.psnr(), 58.5);
        }
    // What stands in the dataset for a held-out view is only where the search begins.
    const Dataset told = make(folder.path() / "told", 1.5);
    EXPECT_NEAR(judge(oracle(TargetSpace::stored), told, Split::test, at_centres).images[0].gain[0], 1.7, 1e-3);
}

TEST_F(Exposure, GainsPerChannelAreUsedInTrainingAndFoundOnHeldOutViews) {
    const TemporaryFolder folder;
    const std::array<std::array<double, 3>, 5> truth = {
        {{0.8, 1, 1.2}, {1, 1, 1}, {1.7, 1.3, 0.9}, {1.25, 1.1, 1}, {1, 1, 1}}};
    Dataset header = sheet_dataset(troubled_mesh(3, 7, 1), 5, 48, 2);
    for (size_t i = 0; i < 5; ++i) header.views[i].gain = i == 2 ? Gain(1) : Gain(truth[i]);
    const Dataset dataset = write_dataset(folder.path() / "data", header, [&](size_t view, int x, int y, int c) {
        const double stored = srgb_encode(2.2 * light(size_t(y * 48 + x), size_t(c)) / truth[view][size_t(c)]);
        return uint8_t(std::lround(255 * std::min(1.0, stored)));
    });
    EXPECT_GT(judge(oracle(TargetSpace::linear), dataset, Split::train, at_centres).psnr(), 58.5);
    const JudgeResult held_out = judge(oracle(TargetSpace::linear), dataset, Split::test, at_centres);
    EXPECT_GT(held_out.psnr(), 58.5);
    for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(held_out.images[0].gain[c], truth[2][c], 2e-3) << c;
    const auto json = nlohmann::json::parse(judge_json(held_out));
    EXPECT_NEAR(json.at("per_image").at(0).at("gain").at(1).get<double>(), truth[2][1], 2e-3);
}

TEST_F(Exposure, NoGainsNoSearch) {
    const TemporaryFolder folder;
    Dataset dataset = make(folder.path() / "data", 1);
    for (View& view : dataset.views) view.gain = 1;
    const JudgeResult result = judge(oracle(TargetSpace::stored), dataset, Split::test, at_centres);
    EXPECT_EQ(result.images[0].gain, 1.0);
    EXPECT_LT(result.psnr(), 30) << "a fixed exposure is part of the answer";
}

TEST_F(Exposure, FiguresDoNotDependOnTheScaleOfTheGains) {
    const TemporaryFolder folder;
    const Dataset dataset = make(folder.path() / "data", 1);
    Dataset darker = dataset;
    for (View& view : darker.views) view.gain = 0.25 * view.gain[0];
    const auto off = [](double scale) {  // a contestant with an error of 5% of the light
        return painter([=](size_t p, size_t c) { return float(scale * 2.2 * light(p, c) * (p % 2 ? 1.05 : 0.95)); },
                       TargetSpace::linear);
    };
    for (const Split split : {Split::train, Split::test})
        EXPECT_NEAR(judge(off(1), dataset, split, at_centres).psnr(),
                    judge(off(0.25), darker, split, at_centres).psnr(), 1e-3);
}

TEST(FindExposure, IsTheLeastOfAll) {
    // Against brute force over a fine grid, for encodings with and without a curve, noise and negative light included.
    Rng rng(9);
    for (const Encoding encoding : {Encoding::u8_srgb, Encoding::u16_linear})
        for (int trial = 0; trial < 4; ++trial) {
            std::vector<float> light, photograph;
            for (int i = 0; i < 300; ++i) {
                light.push_back(rng.uniform(-0.1f, 1.5f));
                photograph.push_back(clamped(light.back() * float(0.4 + 0.5 * trial) + rng.uniform(-0.3f, 0.3f)));
            }
            const auto error = [&](double s) {
                double sum = 0;
                for (size_t i = 0; i < light.size(); ++i) {
                    const double d = exposed(encoding, s, double(light[i])) - double(photograph[i]);
                    sum += d * d;
                }
                return sum;
            };
            const double found = error(find_exposure(encoding, light, photograph, 1));
            for (double stops = -6; stops <= 6; stops += 0.01) ASSERT_LE(found, error(std::exp2(stops)) * (1 + 1e-6));
        }
    const std::vector<float> black(30, 0.0f), gray(30, 0.5f), nan(30, NAN);
    EXPECT_EQ(find_exposure(Encoding::u8_srgb, black, gray, 1.5), 1.5);
    EXPECT_EQ(find_exposure(Encoding::u8_srgb, nan, gray, 1.5), 1.5);
}

// ---- pixels' areas ----

TEST(PixelAreas, PointsLieEvenlyInEachPixel) {
    const Dataset dataset = sheet_dataset(troubled_mesh(3, 7, 1), 1, 48, 2);
    const View& view = dataset.views[0];
    std::mutex mutex;                           // parts of the picture are shaded by several threads, in any order
    std::vector<std::array<double, 2>> points;  // where the surface's points lie in the picture
    const Contestant watcher{[&](const View& seen_by, const auto& seen, std::vector<float>& rgb, int) {
        const std::scoped_lock lock(mutex);
        for (const RasterPixel& p : seen) {
            if (p.triangle == no_triangle) continue;
            const auto& [a, b, c] = dataset.mesh.triangles[p.triangle];
            const auto at = [&](uint32_t vertex) -> Vec3d { return dataset.mesh.positions[vertex].cast<double>(); };
            const double b1 = double(p.b1), b2 = double(p.b2);
            const Vec3d place = seen_by.camera.project((1 - b1 - b2) * at(a) + b1 * at(b) + b2 * at(c));
            points.push_back({place.x(), place.y()});
        }
        rgb.assign(3 * seen.size(), 0.25f);
    }};
    PixelAreas areas(dataset, 3);
    areas.shade(watcher, view, 0);
    std::map<std::pair<int, int>, int> of_thirds;  // of pixels
    for (const auto& point : points) {
        const std::pair third(int(std::floor(3 * point[0])), int(std::floor(3 * point[1])));
        EXPECT_NEAR(3 * point[0], third.first + 0.5, 1e-3);
        EXPECT_NEAR(3 * point[1], third.second + 0.5, 1e-3);
        EXPECT_EQ(++of_thirds[third], 1);
    }
    const int side = view.camera.width;
    double covered = 0;
    for (int i = 0; i < side * side; ++i) {
        int seen = 0;
        for (int k = 0; k < 9; ++k) seen += int(of_thirds.count({3 * (i % side) + k % 3, 3 * (i / side) + k / 3}));
        EXPECT_EQ(areas.coverage(size_t(i)), float(seen) / 9) << i;
        covered += seen;
    }
    EXPECT_GT(covered, 9 * 200);
    points.clear();
    PixelAreas centres(dataset, 1);
    centres.shade(watcher, view, 0);
    for (const auto& point : points)
        for (const double x : point) EXPECT_NEAR(x - std::floor(x), 0.5, 1e-3);
    for (size_t i = 0; i < centres.centres().size(); ++i) {
        EXPECT_EQ(centres.coverage(i), float(centres.centres()[i].triangle != no_triangle));
        EXPECT_EQ(areas.centres()[i].triangle, centres.centres()[i].triangle);
        if (areas.coverage(i) > 0)
            EXPECT_NEAR(areas.rgb()[3 * i], 0.25f, 1e-6f);
        else
            EXPECT_EQ(areas.rgb()[3 * i], 0.0f);
    }
}

// The nine points of a pixel see black or white; the eye, and the camera, see the mean of their light.
TEST(PixelAreas, MeansAreOfLight) {
    const TemporaryFolder folder;
    const Dataset dataset = gray_dataset(folder.path() / "data", 128);
    for (const TargetSpace space : {TargetSpace::stored, TargetSpace::linear}) {
        const Contestant blinking{[&](const View&, const auto& seen, std::vector<float>& rgb, int) {
                                      rgb.resize(3 * seen.size());  // of three points beside one another one is white
                                      for (size_t i = 0; i < rgb.size(); ++i) rgb[i] = float(i / 3 % 3 == 0);
                                  },
                                  space};
        PixelAreas areas(dataset, 3);
        areas.shade(blinking, dataset.views[0], 0);
        const double expected = space == TargetSpace::stored ? srgb_encode(1.0 / 3) : 1.0 / 3;
        int whole = 0;
        for (size_t i = 0; i < areas.centres().size(); ++i) {
            if (areas.coverage(i) < 1) continue;
            ++whole;
            ASSERT_NEAR(areas.rgb()[3 * i + 1], expected, 1e-5);
        }
        EXPECT_GT(whole, 100);
    }
}

// The sheet's outline: shares of pixels add up to nearly the same area, however many points they are of.
TEST(PixelAreas, CoverageAddsUpToTheOutlinesArea) {
    Dataset dataset = sheet_dataset(troubled_mesh(3, 7, 1), 1, 48, 2);
    const Contestant white{
        [](const View&, const auto& pixels, std::vector<float>& rgb, int) { rgb.assign(3 * pixels.size(), 1.0f); }};
    const auto area = [&](int points) {
        const LightImage image = render(white, dataset, dataset.views[0], points);
        for (size_t i = 0; i < image.coverage.size(); ++i) EXPECT_NEAR(image.rgb[3 * i], image.coverage[i], 1e-5);
        return std::accumulate(image.coverage.begin(), image.coverage.end(), 0.0);
    };
    const double fine = area(9);
    EXPECT_LT(std::abs(area(3) / fine - 1), 0.01);
    EXPECT_GT(fine, 200);
    const LightImage image = render(white, dataset, dataset.views[0], 3);
    EXPECT_TRUE(std::ranges::any_of(image.coverage, [](float c) { return c > 0 && c < 1; }));
}

TEST(PixelAreas, RefusesAnEvenNumber) {
    EXPECT_NE(user_error([] { check_pixel_points(2); }).find("odd"), std::string::npos);
    EXPECT_NE(user_error([] { check_pixel_points(11); }).find("9"), std::string::npos);
}

// ---- pictures ----

TEST(Render, ExrIsLinearLight) {
    const TemporaryFolder folder;
    const Dataset dataset = noise_dataset(folder.path() / "data");
    LightFieldFit fit = random_fit(dataset, 1, ViewLookup::bilinear, 3);
    const LightImage stored = render(contestant_of(fit, dataset.mesh), dataset, dataset.views[0], 1);
    fit.space = TargetSpace::linear;
    const LightImage linear = render(contestant_of(fit, dataset.mesh), dataset, dataset.views[0], 1);
    for (size_t i = 0; i < linear.rgb.size(); ++i)
        ASSERT_FLOAT_EQ(stored.rgb[i], float(srgb_decode(double(linear.rgb[i]))));
    write_light_exr(folder.path() / "a.exr", linear);
    const ExrImage back = read_exr(folder.path() / "a.exr", {"G", "A"});
    for (size_t i = 0; i < linear.coverage.size(); ++i) {
        ASSERT_EQ(back.values[2 * i], linear.rgb[3 * i + 1]);
        ASSERT_EQ(back.values[2 * i + 1], linear.coverage[i]);
    }
}

TEST(Render, ComparisonSheet) {
    JudgedView fit{2, 1, {0.5f, 0.5f, 0.5f, 1, 1, 1}, {0.6f, 0.5f, 0.5f, 0, 0, 0}, {1, 0}, 1};
    JudgedView baseline = fit;
    baseline.render = {0.2f, 0.2f, 0.2f, 0, 0, 0};
    const ByteImage sheet = comparison_sheet(fit, &baseline, Encoding::u8_srgb, 4);
    ASSERT_EQ(sheet.width, 4 * 2 + 3 * 4);
    ASSERT_EQ(sheet.height, 1);
    const auto at = [&](int x) { return std::vector<int>(sheet.rgb.begin() + 3 * x, sheet.rgb.begin() + 3 * x + 3); };
    EXPECT_EQ(at(0), (std::vector<int>{128, 128, 128}));   // the photograph
    EXPECT_EQ(at(1), (std::vector<int>{255, 255, 255}));   // its background too
    EXPECT_EQ(at(2), (std::vector<int>{255, 255, 255}));   // the line between
    EXPECT_EQ(at(6), (std::vector<int>{51, 51, 51}));      // the baseline
    EXPECT_EQ(at(12), (std::vector<int>{153, 128, 128}));  // the fit
    EXPECT_EQ(at(18), (std::vector<int>{102, 0, 0}));      // 4 x 0.1
    EXPECT_EQ(at(19), (std::vector<int>{0, 0, 0}));        // not foreground
    fit.render[1] = NAN;
    EXPECT_EQ(comparison_sheet(fit, nullptr, Encoding::u8_srgb).rgb[3 * 6], 255);  // magenta
    EXPECT_EQ(comparison_sheet(fit, nullptr, Encoding::u8_srgb).rgb[3 * 6 + 1], 0);
}

}  // namespace
}  // namespace radiafit::testing

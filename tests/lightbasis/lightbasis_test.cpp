#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "base/parallel.h"
#include "failing_gl.h"
#include "gauss.h"
#include "geometry/direction_hull.h"
#include "lightbasis/choose_kernel.h"
#include "lightbasis/light_error_bars.h"
#include "lightbasis/solve_light_basis.h"
#include "model/value_curve.h"
#include "shared_context.h"
#include "texel_scene.h"

namespace radiafit::testing {
using namespace fits;
namespace {

Vec3d direction_above(Rng& rng, double lowest) {
    const auto d = random_direction(rng, lowest);
    return {d.x, d.y, d.z};
}

TEST(ValueCurve, TurnsBackIntoLight) {
    for (const auto& [name, curve] : value_curves()) {
        EXPECT_EQ(name_of(curve), name);
        float last = -2;
        for (float light = -1.2f; light < 1.5f; light += 0.01f) {
            const float value = on_curve(curve, light);
            EXPECT_GT(value, last);
            EXPECT_NEAR(from_curve(curve, value), light, 1e-6);
            EXPECT_EQ(on_curve(curve, -light), -value);
            last = value;
        }
        EXPECT_NEAR(on_curve(curve, 1.0f), 1, 1e-6);
    }
}

// Values under the reference lamps are what is shown there, and functions that are smooth are met between them.
TEST(LampFunctions, InterpolateBetweenReferenceLamps) {
    Rng rng(1);
    LightBasis basis;
    basis.rank = 1;
    basis.cubes = {{0, 0, 0}};
    basis.length = 0.6f;
    for (int i = 0; i < 60; ++i) basis.lamps.push_back({direction_above(rng, 0).cast<float>()});
    const auto smooth = [](const Vec3f& d) { return Vec3f(d.x(), d.y() * d.z(), 0.3f + 0.5f * d.z()); };
    basis.numbers.resize(basis.block_size());
    auto numbers = LightBasis::Block::Map(basis.numbers.data(), Eigen::Index(basis.rows()), 2);
    for (Eigen::Index c = 0; c < 3; ++c)
        for (size_t i = 0; i < basis.lamps.size(); ++i)
            numbers(c * 60 + Eigen::Index(i), 0) = numbers(c * 60 + Eigen::Index(i), 1) =
                smooth(basis.lamps[i].lamp)[c];
    const LampFunctions functions(basis, sample_smoothing);
    for (int trial = 0; trial < 50; ++trial) {
        const Vec3f elsewhere = direction_above(rng, 0.4).cast<float>(), lamp = basis.lamps[size_t(trial)].lamp;
        for (int column = 0; column < 2; ++column) {
            EXPECT_LT((functions.at(0, {lamp}).col(column) - smooth(lamp)).norm(), 0.01f);
            EXPECT_LT((functions.at(0, {elsewhere}).col(column) - smooth(elsewhere)).norm(), 0.03f);
        }
    }
}

/// The kernel of texels that are sums of bumps over how they are lit and seen, as wide as `bump` says, and of as many
/// over the half vector alone, of this height.
ChosenKernel kernel_of_bumps(Rng& rng, const std::vector<LampAndHalf>& lit, double length, double half_height,
                             double noise, bool with_half) {
    const LightKernel<double> bump{length}, of_half{0.3};
    const auto n = Eigen::Index(lit.size());
    std::vector<Eigen::MatrixXf> values;
    for (int t = 0; t < 40; ++t) {
        values.emplace_back(Eigen::MatrixXf::Zero(n, 3));
        for (int k = 0; k < 10; ++k) {
            const LampAndHalf& centre = lit[rng.index(uint32_t(lit.size()))];
            const double height = double(rng.uniform(-1, 1));
            for (Eigen::Index i = 0; i < n; ++i) {
                const LampAndHalf& at = lit[size_t(i)];
                values.back().row(i).array() += float(height * (bump(at, centre) - 2) +
                                                      half_height * height * (of_half({at.half}, {centre.half}) - 2));
            }
        }
        for (float& x : values.back().reshaped()) x += float(noise * gauss(rng));
    }
    std::vector<LampValues> texels;
    for (const auto& v : values) texels.push_back({&lit, &v});
    return choose_kernel(texels, with_half);
}

// What changes over shorter distances gets a shorter kernel, and noise a larger smoothing.
TEST(ChooseKernel, FindsHowFastValuesChange) {
    Rng rng(6);
    std::vector<LampAndHalf> lamps;
    for (int i = 0; i < 60; ++i) lamps.push_back({direction_above(rng, 0.1).cast<float>()});
    const auto chosen = [&](double length, double noise) {
        return kernel_of_bumps(rng, lamps, length, 0, noise, false);
    };
    EXPECT_GE(chosen(0.8, 0).length, 0.6);
    EXPECT_LE(chosen(0.3, 0).length, 0.4);
    EXPECT_GT(chosen(0.8, 0.3).smoothing, 3 * chosen(0.8, 0.01).smoothing);
}

// What lies around half vectors is told from what changes with the lamp alone.
TEST(ChooseKernel, FindsWhetherValuesChangeWithTheHalfVector) {
    Rng rng(7);
    LightBasis by_half;
    by_half.half_length = 1;
    std::vector<LampAndHalf> lit;
    for (int i = 0; i < 90; ++i) {
        const Vec3f lamp = direction_above(rng, 0.3).cast<float>();
        lit.push_back(by_half.directions_of(lamp, direction_above(rng, 0.3).cast<float>()));
    }
    EXPECT_GT(kernel_of_bumps(rng, lit, 0.8, 0.5, 0.01, true).half_length, 0);
    EXPECT_EQ(kernel_of_bumps(rng, lit, 0.8, 0, 0.01, true).half_length, 0);
}

TEST(NearestInside, IsTheDirectionItselfInsideAndAtTheRimElsewhere) {
    Rng rng(2);
    std::vector<Vec3d> lamps;
    for (int i = 0; i < 12; ++i) lamps.push_back(direction_above(rng, 0.5));
    for (int trial = 0; trial < 100; ++trial) {
        const Vec3d direction = direction_above(rng, -1), inside = nearest_inside(lamps, direction);
        EXPECT_NEAR(inside.norm(), 1, 1e-9);
        EXPECT_LT(angle_outside(lamps, inside), 1e-6);
        const double outside = angle_outside(lamps, direction);
        if (outside == 0) {
            EXPECT_EQ(inside, direction);
        } else if (outside < 1.5) {
            EXPECT_NEAR(std::acos(std::min(1.0, inside.dot(direction))), outside, 1e-6);
        }
    }
}

/// A flat sample, in each view a lamp and a camera, both far away.
class Sheet : public TexelSource {
public:
    static constexpr int side = 40;
    Sheet() : atlas_(make_atlas(Grid::centered(side, side, 1))) { dataset.grid = Grid::centered(side, side, 1); }

    uint32_t texel_count() const override { return side * side; }
    uint64_t sample_count() const override {
        uint64_t count = 0;
        for (const auto& texel : samples_) count += texel.size();
        return count;
    }
    void read(uint32_t begin, TexelSamples& out) const override {
        out.first.assign(1, 0);
        out.samples.clear();
        for (uint32_t t = begin; t < std::min(begin + block, texel_count()); ++t) {
            out.samples.insert(out.samples.end(), samples_[t].begin(), samples_[t].end());
            out.first.push_back(out.samples.size());
        }
    }
    const Atlas& atlas() const { return atlas_; }
    size_t samples_of(uint32_t texel) const { return samples_[texel].size(); }
    std::vector<RasterPixel> pixels() const {
        std::vector<RasterPixel> out(texel_count());
        for (uint32_t t = 0; t < out.size(); ++t) out[t].triangle = t;
        return out;
    }

    Dataset dataset;
    std::vector<uint32_t> views;

protected:
    void add_view(const Vec3d& lamp, const Vec3d& camera) {
        views.push_back(uint32_t(dataset.views.size()));
        View& view = dataset.views.emplace_back();
        view.light = Light{Light::Kind::distant, lamp, Vec3d::Constant(1)};
        view.camera_direction = camera;
    }
    /// Of a share of what value(texel, view) says.
    template <class Value>
    void sample(Rng& rng, float share, double noise, const Value& value) {
        Rng noise_rng(4);
        for (uint32_t t = 0; t < texel_count(); ++t) {
            samples_.emplace_back();
            for (uint32_t i = 0; i < views.size(); ++i) {
                if (rng.uniform() > share) continue;
                const Vec3f seen = value(t, dataset.views[i]);
                TexelRadiance s{{}, i};
                for (int c = 0; c < 3; ++c) s.value[c] = seen[c] + float(noise * gauss(noise_rng));
                samples_.back().push_back(s);
            }
        }
    }

private:
    GridAtlas atlas_;
    std::vector<std::vector<TexelRadiance>> samples_;
};

/// A sheet whose texels' colours are functions of the lamp's direction, drawn from a few that all have in common, the
/// channels joint.
class Relief : public Sheet {
public:
    static constexpr int rank = 4, centres = 6;
    explicit Relief(int lamps, float share = 1, double noise = 0) {
        Rng rng(3);
        for (int i = 0; i < lamps; ++i) add_view(direction_above(rng, 0.3), Vec3d::UnitZ());
        for (int i = 0; i < centres; ++i) centre.push_back(direction_above(rng, 0.3).cast<float>());
        u = Eigen::MatrixXf(3 * centres, rank);
        for (float& x : u.reshaped()) x = 0.06f * rng.uniform(-1, 1);
        z = Eigen::MatrixXf(rank, side * side);
        for (float& x : z.reshaped()) x = rng.uniform(-1.7f, 1.7f);  // variance 1
        sample(rng, share, noise, [&](uint32_t t, const View& view) { return at(t, view.light->place); });
    }

    Vec3f at(uint32_t texel, const Vec3d& lamp) const {
        const LightKernel<double> bump{0.7};
        Eigen::VectorXf bumps(centres);
        for (int i = 0; i < centres; ++i) bumps[i] = float(bump({centre[size_t(i)]}, {lamp.cast<float>()}) - 2);
        Vec3f out;
        for (int c = 0; c < 3; ++c) out[c] = 0.5f + bumps.dot((u * z.col(texel)).segment<centres>(c * centres));
        return out;
    }

    std::vector<Vec3f> centre;  ///< of the bumps that functions are sums of
    Eigen::MatrixXf u, z;
};

/// A sheet with bumps, matt in some colours and glossy in two degrees (Blinn 1977), lamps and cameras anywhere above.
class Gloss : public Sheet {
public:
    explicit Gloss(int count, float gloss = 0.35f, double noise = 0.005) : gloss_(gloss) {
        Rng rng(8);
        for (int i = 0; i < count; ++i) {
            const Vec3d lamp = direction_above(rng, 0.5);
            add_view(lamp, direction_above(rng, 0.5));
        }
        sample(rng, 1, noise, [&](uint32_t t, const View& view) { return at(t, view); });
    }
    Vec3f at(uint32_t texel, const View& view) const {
        const double x = double(texel % side), y = double(texel / side);
        const Vec3d normal = Vec3d(0.2 * std::sin(x / 3), 0.2 * std::sin(y / 4), 1).normalized();
        const Vec3d half = (view.light->place + *view.camera_direction).normalized();
        const Vec3f colour = int(x / 9 + y / 13) % 2 ? Vec3f(0.3f, 0.2f, 0.1f) : Vec3f(0.1f, 0.25f, 0.3f);
        const double exponent = x < y ? 12 : 40;
        const auto highlight = float(std::pow(std::max(0.0, normal.dot(half)), exponent));
        return float(std::max(0.0, normal.dot(view.light->place))) * colour + Vec3f::Constant(gloss_ * highlight);
    }
    /// The same samples, as if one camera had taken them all.
    void stop_camera() {
        for (View& view : dataset.views) view.camera_direction = Vec3d::UnitZ();
    }

private:
    float gloss_;
};

LightBasisFit fit_of(const Sheet& relief, const LightBasisOptions& options) {
    LightBasisFit fit;
    fit.basis = learn_light_basis(relief.dataset, relief.atlas(), relief.views, relief, options);
    const TexelLightReader reader(relief.dataset, relief.atlas(), relief.views, fit.basis);
    LightBasisSolution solution = solve_light_basis(relief.atlas(), relief, reader, fit.basis);
    fit.parameters = std::move(solution.parameters);
    fit.samples = std::move(solution.samples);
    fit.error = std::move(solution.error);
    return fit;
}

/// Root mean square error under lamps amid those of the samples.
double error_from_elsewhere(const Relief& relief, const LightBasisFit& fit) {
    const Contestant shown = contestant_of(fit, relief.atlas(), relief.dataset, relief.views);
    const std::vector<RasterPixel> pixels = relief.pixels();
    double sum = 0;
    size_t count = 0;
    for (size_t i = 0; i + 1 < relief.views.size(); i += 2) {
        View view = relief.dataset.views[i];
        view.light->place = (view.light->place + relief.dataset.views[i + 1].light->place).normalized();
        EXPECT_EQ(shown.share_of_fit(view), 1);
        std::vector<float> rgb;
        shown.shade(view, pixels, rgb, 0);
        for (uint32_t t = 0; t < pixels.size(); ++t) {
            if (relief.samples_of(t) < 3) continue;
            sum += double((Vec3f::Map(&rgb[3 * t]) - relief.at(t, view.light->place)).squaredNorm());
            count += 3;
        }
    }
    return std::sqrt(sum / double(count));
}

// Few samples a texel, other lamps in each: the basis that the surface has in common is found, and fills the gaps.
TEST(LightBasis, FindsWhatTexelsHaveInCommon) {
    const Relief relief(40, 0.2f);
    LightBasisOptions options{.rank = Relief::rank, .noise = 1e-6, .curve = ValueCurve::linear, .rounds = 40};
    const LightBasisFit fit = fit_of(relief, options);
    const double learned = error_from_elsewhere(relief, fit);
    EXPECT_LT(learned, 0.01);  // of colours whose standard deviation is 0.1
    options.rounds = 0;        // as smooth functions are without it
    EXPECT_GT(error_from_elsewhere(relief, fit_of(relief, options)), 3 * learned);
}

// At the solution the gradient of the objective, formed sample by sample in double, is zero.
TEST(LightBasis, SolvesTheNormalEquations) {
    const Relief relief(30, 0.6f, 0.02);
    for (const int rank : {1, 9, 27, 84}) {
        const LightBasisOptions options{.rank = rank, .noise = 1e-3, .blocks = 4, .curve = ValueCurve::linear};
        const LightBasisFit fit = fit_of(relief, options);
        ASSERT_GT(fit.basis.cubes.size(), 1u);
        const LampFunctions functions(fit.basis, sample_smoothing);
        for (uint32_t t = 0; t < relief.texel_count(); t += 97) {
            TexelSamples samples;
            relief.read(t / TexelSource::block * TexelSource::block, samples);
            const size_t block = fit.basis.block_at(relief.atlas().position(t));
            const Eigen::VectorXd z = Eigen::VectorXf::Map(&fit.parameters[t * size_t(rank)], rank).cast<double>();
            Eigen::VectorXd gradient = options.noise * z;
            double size = 0, error = 0;
            for (const TexelRadiance& s : samples.of(t % TexelSource::block)) {
                const Vec3f lamp = relief.dataset.views[s.image].light->place.cast<float>();
                const Eigen::MatrixXd at = functions.at(block, {lamp}).cast<double>();
                for (int c = 0; c < 3; ++c) {
                    const Eigen::VectorXd phi = at.row(c).rightCols(rank).transpose();
                    const double r = at(c, 0) + z.dot(phi) - double(s.value[c]);
                    gradient += r * phi;
                    size += phi.norm();
                    error += 0.5 * r * r;
                }
            }
            EXPECT_LT(gradient.norm(), 1e-4 * size + 1e-6);
            EXPECT_NEAR(fit.error[t], error, 1e-3 * error + 1e-6);
        }
    }
}

/// The same equations by either engine; sums of floats in another order.
void check_engines_agree(const Sheet& sheet, bool by_half) {
    for (const int rank : {1, 9, 27}) {
        const LightBasisOptions options{
            .rank = rank, .noise = 1e-3, .blocks = 4, .curve = ValueCurve::linear, .rounds = 2};
        const LightBasis basis = learn_light_basis(sheet.dataset, sheet.atlas(), sheet.views, sheet, options);
        ASSERT_EQ(basis.by_half(), by_half);
        const TexelLightReader reader(sheet.dataset, sheet.atlas(), sheet.views, basis);
        const auto here = solve_light_basis(sheet.atlas(), sheet, reader, basis),
                   there = solve_on_device(sheet.atlas(), sheet, reader, basis);
        EXPECT_EQ(there.samples, here.samples);
        double size = 0;
        for (const float z : here.parameters) size = std::max(size, std::abs(double(z)));
        for (size_t i = 0; i < here.parameters.size(); ++i)
            ASSERT_NEAR(there.parameters[i], here.parameters[i], 1e-4 * size) << rank;
        for (size_t t = 0; t < here.error.size(); ++t)
            ASSERT_NEAR(there.error[t], here.error[t], 1e-4 * double(here.error[t]) + 1e-7) << rank;
    }
}

TEST(LightBasis, IsSolvedOnTheDeviceAsOnTheCpu) {
    SharedContext::use();
    check_engines_agree(Relief(30, 0.6f, 0.02), false);
}

TEST(LightBasis, IsSolvedOnTheDeviceAsOnTheCpuWhereCamerasMove) {
    SharedContext::use();
    check_engines_agree(Gloss(60), true);
}

TEST(LightBasis, EveryAllocationThatFailsIsTold) {
    SharedContext::use();
    const Relief relief(8, 0.8f);
    const LightBasis basis = learn_light_basis(relief.dataset, relief.atlas(), relief.views, relief,
                                               {.rank = 4, .noise = 1e-3, .blocks = 2, .rounds = 1});
    const TexelLightReader reader(relief.dataset, relief.atlas(), relief.views, basis);
    EXPECT_GE(fail_each_allocation([&] { solve_on_device(relief.atlas(), relief, reader, basis); }), 4);
}

TEST(LightBasis, IsTheSameForAnyNumberOfThreads) {
    const Relief relief(20, 0.7f, 0.02);
    const LightBasisOptions options{.rank = 9, .blocks = 3, .curve = ValueCurve::root};
    const int threads = thread_count();
    set_thread_count(1);
    const LightBasisFit one = fit_of(relief, options);
    set_thread_count(3);
    const LightBasisFit three = fit_of(relief, options);
    set_thread_count(threads);
    EXPECT_EQ(one.basis.numbers, three.basis.numbers);
    EXPECT_EQ(one.parameters, three.parameters);
}

// About as many of the true values lie within a standard deviation as of a normal distribution, under lamps that were
// not seen; somewhat fewer, as the basis is known only so well.
TEST(LightBasis, HasErrorBarsThatCover) {
    const Relief relief(40, 0.3f, 0.02);
    const LightBasisFit fit = fit_of(relief, {.rank = Relief::rank, .noise = 4e-4, .curve = ValueCurve::linear});
    const TexelLightReader reader(relief.dataset, relief.atlas(), relief.views, fit.basis);
    const LightErrorBars bars(fit, relief.atlas(), relief, reader);
    LightBasisSolver solver(fit.basis);
    const Contestant shown = contestant_of(fit, relief.atlas(), relief.dataset, relief.views);
    const std::vector<RasterPixel> pixels = relief.pixels();
    View view = relief.dataset.views[0];
    view.light->place = (view.light->place + 2 * Vec3d::UnitZ()).normalized();
    std::vector<float> rgb;
    shown.shade(view, pixels, rgb, 0);
    size_t within = 0, count = 0;
    double noise = 0;
    for (uint32_t t = 0; t < pixels.size(); ++t) {
        if (relief.samples_of(t) < 5) continue;
        const Vec3f deviation = bars.of_value(t, 0, {view.light->place.cast<float>()}, solver);
        const Vec3f error = Vec3f::Map(&rgb[3 * t]) - relief.at(t, view.light->place);
        for (int c = 0; c < 3; ++c) within += std::abs(error[c]) <= deviation[c], ++count;
        noise += double(bars.noise[t]) / double(pixels.size());
    }
    EXPECT_NEAR(noise, 0.02, 0.002);
    EXPECT_GT(double(within) / double(count), 0.55);
    EXPECT_LT(double(within) / double(count), 0.75);
}

// Beyond the lamps that were fitted it neither explodes nor turns black at once, and darkens towards the horizon.
TEST(LightBasis, StaysTameBeyondItsLamps) {
    const Relief relief(25, 1, 0.02);
    const LightBasisFit fit = fit_of(relief, {.rank = 27, .curve = ValueCurve::srgb});
    const Contestant shown = contestant_of(fit, relief.atlas(), relief.dataset, relief.views);
    const std::vector<RasterPixel> pixels = relief.pixels();
    double last = 2;
    for (const double height : {0.3, 0.1, 0.02, 0.0}) {
        View view = relief.dataset.views[0];
        view.light->place = Vec3d(std::sqrt(1 - height * height), 0, height);
        std::vector<float> rgb;
        shown.shade(view, pixels, rgb, 0);
        double sum = 0;
        for (const float value : rgb) {
            ASSERT_TRUE(std::isfinite(value));
            ASSERT_GE(value, 0);
            sum += double(value);
        }
        EXPECT_LT(sum / double(rgb.size()), last);
        last = sum / double(rgb.size());
    }
    EXPECT_EQ(last, 0);
}

/// Root mean square error under lamps and from cameras amid those of the samples, values on sRGB's curve.
double error_amid(const Gloss& truth, const Sheet& fitted, const LightBasisFit& fit) {
    const Contestant shown = contestant_of(fit, fitted.atlas(), fitted.dataset, fitted.views);
    double sum = 0;
    size_t count = 0;
    for (size_t i = 0; i + 1 < truth.views.size(); i += 2) {
        const View &one = truth.dataset.views[i], &other = truth.dataset.views[i + 1];
        View view = one;
        view.light->place = (one.light->place + other.light->place).normalized();
        view.camera_direction = (*one.camera_direction + *other.camera_direction).normalized();
        std::vector<float> rgb;
        shown.shade(view, truth.pixels(), rgb, 0);
        for (uint32_t t = 0; t < truth.texel_count(); ++t) {
            const Vec3f light = truth.at(t, view);
            for (int c = 0; c < 3; ++c, ++count)
                sum += std::pow(double(srgb_encode(rgb[3 * t + size_t(c)])) - double(srgb_encode(light[c])), 2);
        }
    }
    return std::sqrt(sum / double(count));
}

// Of a glossy surface a basis of lamps and views knows what one of lamps alone has to take for noise.
TEST(LightBasis, TellsViewsApartWhereCamerasMove) {
    const Gloss gloss(100);
    Gloss one_camera(100);
    one_camera.stop_camera();
    const LightBasisOptions options{.rank = 18};
    const LightBasisFit both = fit_of(gloss, options), of_lamps = fit_of(one_camera, options);
    EXPECT_TRUE(both.basis.by_half());
    EXPECT_FALSE(of_lamps.basis.by_half());
    EXPECT_LT(error_amid(gloss, gloss, both), 0.6 * error_amid(gloss, one_camera, of_lamps));
}

// Where the view does not matter, it is left out.
TEST(LightBasis, LeavesTheViewOutOfMattSurfaces) {
    const Gloss matt(50, 0);
    const LightBasis basis = learn_light_basis(matt.dataset, matt.atlas(), matt.views, matt, {.rank = 9});
    EXPECT_FALSE(basis.by_half());
    EXPECT_EQ(description_of(basis).find("half"), std::string::npos);
}

// Lamps and cameras beyond those that were fitted show what a surface could.
TEST(LightBasis, StaysTameBeyondItsCameras) {
    const Gloss gloss(60);
    const LightBasisFit fit = fit_of(gloss, {.rank = 27});
    ASSERT_TRUE(fit.basis.by_half());
    const Contestant shown = contestant_of(fit, gloss.atlas(), gloss.dataset, gloss.views);
    Rng rng(9);
    for (int trial = 0; trial < 40; ++trial) {
        View view = gloss.dataset.views[0];
        view.light->place = direction_above(rng, 0.05);
        view.camera_direction = direction_above(rng, 0.05);
        std::vector<float> rgb;
        shown.shade(view, gloss.pixels(), rgb, 0);
        for (const float value : rgb) {
            ASSERT_TRUE(std::isfinite(value));
            ASSERT_GE(value, 0);
            ASSERT_LT(value, 1.5f);  // twice the brightest that there is
        }
    }
    View far = gloss.dataset.views[0];
    far.camera_direction = Vec3d(0.995, 0, 0.1).normalized();
    EXPECT_LT(shown.share_of_fit(far), 1);
}

TEST(LightBasis, IsDescribedWhole) {
    const Relief relief(12);
    const LightBasis basis = learn_light_basis(relief.dataset, relief.atlas(), relief.views, relief,
                                               {.rank = 5, .blocks = 3, .curve = ValueCurve::root});
    LightBasis again = described_light_basis(description_of(basis));
    again.numbers = basis.numbers;
    EXPECT_EQ(description_of(again), description_of(basis));
    EXPECT_EQ(again.curve, ValueCurve::root);
    EXPECT_EQ(again.frame->normal, Vec3f::UnitZ());
    EXPECT_FALSE(again.by_half());
    LightBasisFit fit;
    fit.basis = basis;
    EXPECT_EQ(maps_of(fit).size(), 2u);  // three numbers and two
    EXPECT_EQ(maps_of(fit)[1].channels.size(), 2u);
    fit.underneath = find_texel_model("lafortune");
    EXPECT_EQ(fit.numbers(), 5u + 9u);
    EXPECT_EQ(maps_of(fit)[2].first, 5u);
}

TEST(LightBasis, IsDescribedWholeWithItsHalfVectors) {
    LightBasis basis;
    basis.cubes = {{0, 0, 0}};
    basis.noise = 1e-3f;
    basis.half_length = 0.25f;
    basis.half_share = 0.125f;
    basis.lamps = {{Vec3f::UnitZ(), Vec3f::UnitX()}, {Vec3f::UnitY(), Vec3f::UnitZ()}};
    const std::string told = description_of(basis);
    const LightBasis again = described_light_basis(told);
    EXPECT_EQ(description_of(again), told);
    EXPECT_EQ(again.lamps, basis.lamps);
    EXPECT_EQ(again.half_length, 0.25f);
    EXPECT_EQ(again.half_share, 0.125f);
    const auto refused = [&](const std::string& from, const std::string& to) {
        std::string wrong = told;
        wrong.replace(wrong.find(from), from.size(), to);
        EXPECT_ANY_THROW(described_light_basis(wrong)) << wrong;
    };
    refused("\"half_share\"", "\"share\"");
    refused("0.25", "-0.25");
    refused("0.25", "null");
    refused("0.125", "1.5");
    refused("\"halves\"", "\"thirds\"");
    refused(",[0.0,1.0,0.0]]", "]");
}

}  // namespace
}  // namespace radiafit::testing

// What is known of texels by the others of their surface: learned from scattered parameters, and in fits.
#include "cpu/surface_prior.h"

#include <gtest/gtest.h>

#include <cmath>

#include "dataset/texel_shading.h"
#include "gauss.h"
#include "model/texel_texts.h"
#include "samples/picked_texels.h"
#include "texel_scene.h"

namespace radiafit {
namespace {

using namespace testing;

constexpr int width = 48, height = 32;

/// A flat grid under distant lamps, seen from above and aside.
Dataset lamps(size_t images, uint64_t seed) {
    Dataset dataset;
    dataset.grid = Grid::centered(width, height, 1);
    Rng rng(seed);
    for (size_t i = 0; i < images; ++i) {
        View view;
        view.camera.width = width, view.camera.height = height;
        const auto v = random_direction(rng, 0.4), u = random_direction(rng, 0.3);
        view.camera_direction = Vec3d(v.x, v.y, v.z);
        view.light = Light{.place = Vec3d(u.x, u.y, u.z)};
        dataset.views.push_back(view);
    }
    return dataset;
}

/// Lafortune's parameters scattered about a mean that is another on the right than on the left.
struct Surface {
    static constexpr double of_diffuse = 0.06, of_exponent = 0.1;
    const TexelModel& model = *find_texel_model("lafortune");
    size_t n = size_t(model.parameters);
    Dataset dataset;
    std::unique_ptr<Atlas> atlas;
    std::vector<uint32_t> views;
    std::vector<float> truth;

    explicit Surface(size_t images = 40) : dataset(lamps(images, 1)), atlas(texel_atlas(dataset, 0)) {
        for (uint32_t v = 0; v < images; ++v) views.push_back(v);
        Rng rng(2);
        for (uint32_t t = 0; t < atlas->texel_count(); ++t) {
            std::vector<float> p = mean(t);
            for (size_t i = 0; i < 6; ++i) p[i] += float(of_diffuse * gauss(rng));
            p[8] += float(of_exponent * gauss(rng));
            truth.insert(truth.end(), p.begin(), p.end());
        }
    }
    static bool right(uint32_t t) { return t % width >= width / 2; }
    static std::vector<float> mean(uint32_t t) {
        return {right(t) ? 0.6f : 0.3f, 0.3f, 0.2f, 0.5f, 0.5f, 0.5f, -1, right(t) ? 0.8f : 0.9f, std::log(8.0f)};
    }
    TexelOptions options() const {
        TexelOptions o;
        o.model = &model;
        return o;
    }
    /// A fit that found the truth, with residuals of this standard deviation.
    TexelResult result(double noise) const {
        TexelResult out;
        out.parameters = truth;
        const size_t texels = atlas->texel_count();
        out.status.assign(texels, Status::stationary);
        out.samples.assign(texels, 40);
        out.error.assign(texels, float(0.5 * noise * noise * (3 * 40 - 9)));
        return out;
    }
    std::vector<float> parameters_of(const TexelResult& fit, uint32_t t) const {
        return {&fit.parameters[t * n], &fit.parameters[t * n] + n};
    }
};

TEST(SurfacePrior, LearnsMeansByPlaceAndHowFarTexelsScatter) {
    const Surface surface;
    const auto prior = learn_surface_prior(surface.model, *surface.atlas, surface.result(0.01));
    ASSERT_TRUE(prior);
    ASSERT_EQ(prior->weights.size(), 5u);
    // the scatter about the medians of up to 128 texels, by the median of thousands: to some percent
    EXPECT_NEAR(prior->weights[0], std::pow(0.01 / Surface::of_diffuse, 2),
                0.1 * std::pow(0.01 / Surface::of_diffuse, 2));
    EXPECT_NEAR(prior->weights[4], std::pow(0.01 / Surface::of_exponent, 2),
                0.1 * std::pow(0.01 / Surface::of_exponent, 2));
    for (uint32_t t = 0; t < surface.atlas->texel_count(); ++t) {
        const auto found = prior->mean_of(t);
        const auto expected = Surface::mean(t);
        for (size_t i = 0; i < surface.n; ++i)  // four standard deviations of a median of 64
            ASSERT_NEAR(found[i], expected[i], i == 8 ? 0.08 : 0.05) << t << " " << i;
    }
}

TEST(SurfacePrior, LearnsNothingFromTexelsThatAreNotDetermined) {
    const Surface surface;
    TexelResult wild = surface.result(0.01);
    for (uint32_t t = 0; t < surface.atlas->texel_count(); t += 3) {
        wild.status[t] = Status::underdetermined;
        for (size_t i = 0; i < surface.n; ++i) wild.parameters[t * surface.n + i] = 1;
    }
    const auto calm = learn_surface_prior(surface.model, *surface.atlas, surface.result(0.01)),
               prior = learn_surface_prior(surface.model, *surface.atlas, wild);
    ASSERT_TRUE(calm && prior);
    for (size_t i = 0; i < prior->weights.size(); ++i) EXPECT_NEAR(prior->weights[i] / calm->weights[i], 1, 0.2);
    wild.status.assign(wild.status.size(), Status::underdetermined);
    EXPECT_FALSE(learn_surface_prior(surface.model, *surface.atlas, wild));
}

/// So many of the samples of each texel, from the truth with noise.
class FewSamples final : public TexelSource {
public:
    FewSamples(const Surface& surface, double noise, const std::function<size_t(uint32_t)>& count) {
        Rng rng(3);
        for (uint32_t t = 0; t < surface.atlas->texel_count(); ++t) {
            auto& of_texel = samples_.emplace_back();
            const auto place = TexelShading::place(*surface.atlas, t);
            for (uint32_t image = 0; image < std::min(count(t), surface.views.size()); ++image) {
                const auto lit = TexelShading::lit(place, surface.dataset.views[image]);
                const auto value = surface.model.value({&surface.truth[t * surface.n], surface.n}, lit.u, lit.v);
                TexelRadiance sample{{}, image};
                for (size_t c = 0; c < 3; ++c) sample.value[c] = value[c] + float(noise * gauss(rng));
                of_texel.push_back(sample);
                ++all_;
            }
        }
    }
    uint32_t texel_count() const override { return uint32_t(samples_.size()); }
    uint64_t sample_count() const override { return all_; }
    void read(uint32_t begin, TexelSamples& out) const override {
        out = {{0}, {}};
        for (uint32_t t = begin; t < std::min(begin + block, texel_count()); ++t) {
            out.samples.insert(out.samples.end(), samples_[t].begin(), samples_[t].end());
            out.first.push_back(out.samples.size());
        }
    }

private:
    std::vector<std::vector<TexelRadiance>> samples_;
    uint64_t all_ = 0;
};

// Of some texels of several blocks, the last block left out: their own samples, wherever they stand.
TEST(SurfacePrior, PickedTexelsKeepTheirSamples) {
    const Surface surface;
    const FewSamples source(surface, 0.01, [](uint32_t t) -> size_t { return t % 5; });
    std::vector<uint32_t> texels;
    for (uint32_t t = 3; t < source.texel_count() - TexelSource::block; t += 1 + t % 3) texels.push_back(t);
    const PickedTexels picked(source, texels);
    ASSERT_EQ(picked.texel_count(), texels.size());
    ASSERT_GT(picked.block_count(), 2u);
    const TexelSamples spread = samples_of(source, texels);
    ASSERT_EQ(spread.first.size(), source.texel_count() + 1);
    TexelSamples expected, found;
    uint64_t sum = 0;
    for (uint32_t i = 0; i < texels.size(); ++i) {
        const uint32_t t = texels[i], block = TexelSource::block;
        source.read(t - t % block, expected);
        picked.read(i - i % block, found);
        const auto own = expected.of(t % block), same = found.of(i % block), also = spread.of(t);
        ASSERT_EQ(own.size(), t % 5);
        ASSERT_TRUE(own.size() == same.size() && own.size() == also.size());
        for (size_t k = 0; k < own.size(); ++k)
            for (const TexelRadiance& other : {same[k], also[k]})
                ASSERT_TRUE(other.image == own[k].image && std::ranges::equal(other.value, own[k].value));
        sum += own.size();
    }
    EXPECT_EQ(picked.sample_count(), sum);
    EXPECT_EQ(spread.samples.size(), sum);
}

TEST(SurfacePrior, FewSamplesFallBackToTheTexelsAround) {
    const Surface surface;
    // of every sixteen texels: none, one, two, three samples, and twelve with all
    const auto count = [](uint32_t t) -> size_t { return t % 16 < 4 ? t % 16 : 40; };
    const FewSamples source(surface, 0.01, count);
    const TexelOptions options = surface.options();
    const TexelLoader loader(surface.dataset, *surface.atlas, surface.views, options);
    const TexelProblem problem{source, loader, options};
    const TexelSolvers& solvers = texel_solvers(surface.model);
    const TexelResult alone = solvers.solve_lm(problem, {}, {});
    const auto prior = learn_surface_prior(surface.model, *surface.atlas, alone);
    ASSERT_TRUE(prior);
    const TexelResult fit = solve_lm_with_surface(problem, *surface.atlas, {}, {});
    std::array<double, 4> off{}, off_alone{};
    std::array<size_t, 4> texels{};
    const auto far = [&](const TexelResult& of, uint32_t t) {  // of what an image from elsewhere would show
        const auto lit = TexelShading::lit(TexelShading::place(*surface.atlas, t), surface.dataset.views[30]);
        const auto found = surface.model.value(surface.parameters_of(of, t), lit.u, lit.v),
                   expected = surface.model.value({&surface.truth[t * surface.n], surface.n}, lit.u, lit.v);
        return std::abs(double(found[0] - expected[0]));
    };
    for (uint32_t t = 0; t < source.texel_count(); ++t) {
        for (size_t i = 0; i < surface.n; ++i) ASSERT_TRUE(std::isfinite(fit.parameters[t * surface.n + i]));
        EXPECT_EQ(fit.status[t], count(t) == 40 ? alone.status[t]
                                 : count(t)     ? Status::underdetermined
                                                : Status::no_samples);
        if (count(t) == 40) {
            EXPECT_EQ(surface.parameters_of(fit, t), surface.parameters_of(alone, t));
        }
        if (count(t) == 0) {
            EXPECT_EQ(surface.parameters_of(fit, t),
                      std::vector<float>(prior->mean_of(t).begin(), prior->mean_of(t).end()));
        }
        const size_t group = count(t) == 40 ? 0 : count(t);
        if (t % 16 == 0) continue;
        ++texels[group];
        off[group] += far(fit, t), off_alone[group] += far(alone, t);
    }
    // few: as far off as texels scatter, or less, where they were anywhere
    const double scatter = Surface::of_diffuse * 1.5;
    for (size_t few = 1; few < 4; ++few) {
        EXPECT_LT(off[few] / double(texels[few]), scatter) << few;
        EXPECT_LT(off[few], 0.5 * off_alone[few]) << few;
    }
}

}  // namespace
}  // namespace radiafit

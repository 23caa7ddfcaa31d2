#include <gtest/gtest.h>

#include <cmath>

#include "base/parallel.h"
#include "cpu/texel_fit_impl.h"
#include "fit_scene.h"
#include "sg/sg_fit.h"
#include "sg/sg_text.h"
#include "viewbasis/texel_views.h"

namespace radiafit::testing {
using namespace fits;
namespace {

constexpr int lobes = 2;
using Exact = texel_text::SphericalGaussians<double, lobes>;
using Model = TexelLocal<Exact>;

Exact::Terms random_direction(Rng& rng) {
    const float z = rng.uniform(0.2f, 1), turn = rng.uniform(0, 6.28f), r = std::sqrt(1 - z * z);
    return {{double(r * std::cos(turn)), double(r * std::sin(turn)), double(z)}};
}

/// Two lobes well apart, and a colour below them.
Model::Parameters random_truth(Rng& rng) {
    Model::Parameters p{};
    for (size_t i = 0; i < 9; ++i) p[i] = double(rng.uniform(0.1f, 0.5f));
    const float turn = rng.uniform(0, 6.28f);
    for (size_t l = 0; l < lobes; ++l) {
        const float r = rng.uniform(0.2f, 0.5f), at = turn + 3.14f * float(l);
        p[9 + 3 * l] = double(r * std::cos(at));
        p[10 + 3 * l] = double(r * std::sin(at));
        p[11 + 3 * l] = double(rng.uniform(std::log(4.0f), std::log(30.0f)));
    }
    return p;
}

TEST(SphericalGaussians, SlopesAreThoseOfDifferences) {
    Rng rng(1);
    for (int trial = 0; trial < 100; ++trial) {
        const auto p = random_truth(rng);
        const auto t = random_direction(rng);
        const auto q = Model::columns(Model::shape_of(p), t);
        for (int i = 0; i < Model::shape; ++i) {
            constexpr double h = 1e-5;
            auto high = p, low = p;
            high[size_t(9 + i)] += h;
            low[size_t(9 + i)] -= h;
            for (size_t c = 0; c < 3; ++c) {
                const double difference = (Model::value(high, t)[c] - Model::value(low, t)[c]) / (2 * h);
                const double slope = p[3 * size_t(Model::slope_basis(i)) + c] * q[size_t(Model::basis + i)];
                EXPECT_NEAR(slope, difference, 1e-7);
            }
        }
    }
}

TEST(SphericalGaussians, StartsByProductsAreTheLobes) {
    using One = texel_text::SphericalGaussians<double, 1>;
    Rng rng(2);
    const auto& starts = One::lobe_starts();
    EXPECT_EQ(starts.size(), 32u * 4);
    for (size_t first = 0; first < starts.size(); first += One::lobe_group) {
        const auto d = random_direction(rng);
        const One::Terms t{{d.x[0], d.x[1], d.x[2]}};
        double lobe[One::lobe_group];
        One::one_lobe_at_starts(first, t, lobe);
        for (size_t g = 0; g < size_t(One::lobe_group); ++g) {
            const auto& s = starts[first + g];
            EXPECT_NEAR(lobe[g], One::basis({{s[0], s[1], s[2]}}, t).x[1], 1e-6);
        }
    }
}

using Text = texel_text::SphericalGaussians<Pack, lobes>;
using Fit = TexelFit<Text>;

Fit::Batch samples_of(const std::vector<Model::Parameters>& truth, int samples, Rng& rng) {
    Fit::Batch batch;
    batch.clear();
    for (size_t lane = 0; lane < truth.size(); ++lane)
        for (int i = 0; i < samples; ++i) {
            const auto t = random_direction(rng);
            const auto m = Model::value(truth[lane], t);
            batch.push(int(lane), {{float(t.x[0]), float(t.x[1]), float(t.x[2])},
                                   {float(m[0]), float(m[1]), float(m[2])},
                                   float(t.x[2])});
        }
    return batch;
}

// Samples without noise, and hardly a prior: the greedy start is near enough for the lobes to be found.
TEST(SphericalGaussians, FindsTheLobesThatMadeTheSamples) {
    Rng rng(3);
    int good = 0, all = 0;
    for (int trial = 0; trial < 20; ++trial) {
        std::vector<Model::Parameters> truth(8);
        for (auto& p : truth) p = random_truth(rng);
        const auto batch = samples_of(truth, 60, rng);
        Fit::Prior prior;
        prior.weight.fill(1e-9);
        const auto fitted = Fit({.iterations = 200, .tolerance = 1e-9}).solve(batch, nullptr, &prior);
        for (size_t lane = 0; lane < 8; ++lane, ++all) {
            Model::Parameters p;
            std::copy(fitted[lane].parameters.begin(), fitted[lane].parameters.end(), p.begin());
            double worst = 0;
            for (int i = 0; i < 40; ++i) {
                const auto t = random_direction(rng);
                for (size_t c = 0; c < 3; ++c)
                    worst = std::max(worst, std::abs(Model::value(p, t)[c] - Model::value(truth[lane], t)[c]));
            }
            good += worst < 0.01;
        }
    }
    EXPECT_GT(good, 0.9 * all);
}

// E with its prior is no higher at the end than a little beside it, in any parameter.
TEST(SphericalGaussians, EndsWhereThePriorAndTheSamplesBalance) {
    Rng rng(4);
    std::vector<Model::Parameters> truth(8);
    for (auto& p : truth) p = random_truth(rng);
    const auto batch = samples_of(truth, 9, rng);  // fewer than the parameters need
    Fit::Prior prior;
    for (size_t c = 0; c < 3; ++c) prior.mean[c][0] = 0.3;
    prior.weight.fill(0.02);
    prior.shape_weight.fill(0.01);
    for (size_t i = 0; i < prior.shape_mean.size(); ++i) prior.shape_mean[i] = i % 3 == 2 ? 2.0 : 0.1;
    const auto fitted = Fit({.iterations = 500, .tolerance = 1e-12}).solve(batch, nullptr, &prior);
    for (int lane = 0; lane < 8; ++lane) {
        Model::Parameters best;
        std::copy(fitted[size_t(lane)].parameters.begin(), fitted[size_t(lane)].parameters.end(), best.begin());
        const auto objective = [&](const Model::Parameters& p) {
            double sum = 0;
            for (const auto& row : batch.rows()) {
                const auto m = Model::value(p, {{row.term[0][lane], row.term[1][lane], row.term[2][lane]}});
                for (size_t c = 0; c < 3; ++c)
                    sum += 0.5 * double(row.weight[lane]) * std::pow(m[c] - double(row.target[c][lane]), 2);
            }
            for (size_t i = 0; i < 9; ++i) sum += 0.5 * 0.02 * std::pow(p[i] - (i < 3 ? 0.3 : 0.0), 2);
            for (size_t i = 0; i < 6; ++i) sum += 0.5 * 0.01 * std::pow(p[9 + i] - (i % 3 == 2 ? 2.0 : 0.1), 2);
            return sum;
        };
        const double at_best = objective(best);
        EXPECT_NEAR(fitted[size_t(lane)].error, at_best, 1e-4 * at_best);
        for (size_t i = 0; i < best.size(); ++i)
            for (const double h : {-0.01, 0.01}) {
                auto beside = best;
                beside[i] += h;
                const auto [low, high] = Model::bounds(int(i));
                if (beside[i] < low || beside[i] > high) continue;
                EXPECT_GT(objective(beside), at_best - 1e-6 * at_best) << "lane " << lane << ", parameter " << i;
            }
    }
}

class SgSurface : public ::testing::Test {
protected:
    SgSurface() : dataset(sheet_dataset(troubled_mesh(4, 6, 5), 20, 32, 3)), atlas(dataset.mesh, 6) {
        samples = random_samples(atlas, 20, 0.7f, 4);
    }
    Dataset dataset;
    TriangleAtlas atlas;
    SampleList samples;
};

TEST_F(SgSurface, IsTheSameByAnyNumberOfThreads) {
    const auto fitted = [&](int threads) {
        set_thread_count(threads);
        auto solution = solve_sg(dataset, atlas, samples, mean_up(dataset), {.lobes = 3});
        set_thread_count(0);
        return solution.parameters;
    };
    EXPECT_EQ(fitted(1), fitted(3));
}

TEST_F(SgSurface, WhatNobodySeesHasTheMeanColourAndNoLobes) {
    samples = random_samples(atlas, 20, 0.02f, 4);
    const auto solution = solve_sg(dataset, atlas, samples, mean_up(dataset), {.lobes = 2});
    int unseen = 0;
    for (uint32_t tile = 0; tile < atlas.tile_count(); ++tile)
        for (uint32_t l = 0; l < atlas.texels_per_tile() && !atlas.degenerate(tile); ++l) {
            const size_t texel = tile * atlas.texels_per_tile() + l;
            if (solution.samples[texel] > 0) continue;
            ++unseen;
            EXPECT_EQ(solution.status[texel], Status::no_samples);
            const float* p = &solution.parameters[texel * sg_parameters(2)];
            EXPECT_TRUE(std::all_of(p, p + 3, [](float x) { return x > 0 && x < 1; }));
            EXPECT_TRUE(std::all_of(p + 3, p + 9, [](float x) { return x == 0; }));
        }
    EXPECT_GT(unseen, 10);
}

// Two parts of the samples sum up to the whole, and colour what none of them shows as it does.
TEST_F(SgSurface, PartsKnowTheMeanColourTogether) {
    samples = random_samples(atlas, 20, 0.02f, 4);
    const auto whole = solve_sg(dataset, atlas, samples, mean_up(dataset), {.lobes = 1});
    ColourSum sum;
    for (const bool second : {false, true}) {
        SampleList part = samples;
        const size_t half = samples.samples.size() / 2;
        part.samples.assign(samples.samples.begin() + ptrdiff_t(second ? half : 0),
                            second ? samples.samples.end() : samples.samples.begin() + ptrdiff_t(half));
        for (SampleGroup& group : part.groups)
            group.first = second ? std::max(group.first, half) - half : std::min<uint64_t>(group.first, half);
        sum.add(solve_sg(dataset, atlas, part, mean_up(dataset), {.lobes = 1}).colours);
    }
    EXPECT_EQ(sum.rgb, whole.colours.rgb);
    EXPECT_EQ(sum.mean(), whole.colours.mean());
    auto coloured = whole.parameters;
    colour_unseen(atlas, whole.samples, 1, Vec3f::Constant(-1), coloured);
    size_t changed = 0;
    for (size_t i = 0; i < coloured.size(); ++i) {
        if (coloured[i] == whole.parameters[i]) continue;
        ++changed;
        EXPECT_EQ(coloured[i], -1);
        EXPECT_EQ(whole.parameters[i], whole.colours.mean()[Eigen::Index(i % size_t(sg_parameters(1)))]);
    }
    EXPECT_GT(changed, 0u);
    colour_unseen(atlas, whole.samples, 1, sum.mean(), coloured);
    EXPECT_EQ(coloured, whole.parameters);
}

}  // namespace
}  // namespace radiafit::testing

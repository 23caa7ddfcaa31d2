// What radiafit-bench checks devices by: it must see every sum that is wrong, and pass over no device that is right.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "base/log.h"
#include "bench/light_field_scene.h"
#include "bench/rows.h"
#include "bench/texel_scene.h"
#include "synthetic/synthetic.h"
#include "temporary_folder.h"

namespace radiafit {
using namespace harness;
namespace {

constexpr size_t sites = 3000, problems = 2, parameters = 5;  // of a site

/// Exact sums of made-up sites, the first of which has no samples.
ExactSums some_sums() {
    ExactSums exact;
    exact.samples.assign(sites, 7);
    exact.samples[0] = 0;
    for (size_t q = 0; q < quantity_names.size(); ++q) {
        const size_t each = q == gradient_sum || q == diagonal_sum ? parameters : problems;
        for (size_t i = 0; i < each * sites; ++i) exact.sums[q].push_back({std::sin(double(i)), 2.0});
    }
    for (size_t site = 0; site <= sites; ++site) exact.first_parameter.push_back(parameters * site);
    return exact;
}

DeviceSums rounded(const ExactSums& exact) {
    DeviceSums sums;
    sums.samples = exact.samples;
    for (size_t q = 0; q < quantity_names.size(); ++q)
        for (const ExactSum& sum : exact.sums[q]) sums.sums[q].push_back(float(sum.value));
    return sums;
}

bool says(const Agreement& agreement, const std::string& words) {
    return agreement.disagreement().find(words) != std::string::npos;
}

TEST(Agreement, PassesRoundings) {
    const ExactSums exact = some_sums();
    const Agreement agreement = compare(rounded(exact), exact);
    EXPECT_EQ(agreement.disagreement(), "");
    EXPECT_EQ(agreement.sites, sites - 1);
    for (const double worst : agreement.worst) {
        EXPECT_GT(worst, 0);
        EXPECT_LT(worst, 1e-7);
    }
}

TEST(Agreement, NamesEverySumThatIsWrong) {
    const ExactSums exact = some_sums();
    for (size_t q = 0; q < quantity_names.size(); ++q)
        for (const size_t i :
             {exact.sums[q].size() / sites, exact.sums[q].size() - 1}) {  // of the second and last site
            DeviceSums sums = rounded(exact);
            float& entry = sums.sums[q][i];
            const float right = entry;
            entry = right + float(0.5 * Agreement::tolerance * exact.sums[q][i].magnitude);
            EXPECT_EQ(compare(sums, exact).disagreement(), "") << quantity_names[q];
            for (const float wrong :
                 {right + float(2 * Agreement::tolerance * exact.sums[q][i].magnitude), -right,
                  std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
                entry = wrong;
                const Agreement agreement = compare(sums, exact);
                EXPECT_TRUE(says(agreement, std::string(quantity_names[q]) + " off by")) << wrong << " for " << right;
                for (size_t other = 0; other < quantity_names.size(); ++other) {
                    if (other != q) {
                        EXPECT_LT(agreement.worst[other], 1e-7);
                    }
                }
            }
        }
}

TEST(Agreement, ASumOfNothingMustBeNothing) {
    ExactSums exact = some_sums();
    exact.sums[gradient_sum].back() = {0, 0};
    DeviceSums sums = rounded(exact);
    EXPECT_EQ(compare(sums, exact).disagreement(), "");
    sums.sums[gradient_sum].back() = 1e-20f;
    EXPECT_TRUE(says(compare(sums, exact), "gradient off by inf"));
}

TEST(Agreement, LeavesSitesOutThatHaveNoneOrOtherSamples) {
    const ExactSums exact = some_sums();
    DeviceSums sums = rounded(exact);
    sums.sums[error_sum][0] = 1e9f;  // of the one without samples
    EXPECT_EQ(compare(sums, exact).disagreement(), "");
    for (size_t site = 1; site <= 2; ++site) {
        sums.samples[site] = 8;
        sums.sums[error_sum][problems * site] = 1e9f;
    }
    EXPECT_EQ(compare(sums, exact).disagreement(), "");
    EXPECT_EQ(compare(sums, exact).other_sites, 2u);
    for (size_t site = 1; site < sites; site += 9) sums.samples[site] = 6;
    EXPECT_TRUE(
        says(compare(sums, exact), "of 2999 vertices or texels took other samples: too few are left to compare"));
    sums = rounded(exact);
    sums.samples[0] = 1;
    EXPECT_EQ(compare(sums, exact).other_sites, 1u);
}

// The rule counts samples: among many, one that falls to the other side of an edge says nothing of a device.
TEST(Agreement, ADeviceThatTakesOtherSamplesIsMarkedAndNotRefused) {
    ExactSums exact = some_sums();
    for (size_t site = 1; site < sites; ++site) exact.samples[site] = 1000;
    DeviceSums sums = rounded(exact);
    for (size_t site = 1; site <= 15; ++site) sums.samples[site] += site % 2 ? 1 : -1;
    EXPECT_EQ(compare(sums, exact).other_samples, 15u);
    EXPECT_FALSE(compare(sums, exact).takes_others());
    for (size_t site = 16; site <= 45; ++site) ++sums.samples[site];
    EXPECT_TRUE(compare(sums, exact).takes_others());
    EXPECT_EQ(compare(sums, exact).disagreement(), "");
}

TEST(Agreement, RefusesSumsOfOtherSites) {
    const ExactSums exact = some_sums();
    DeviceSums sums = rounded(exact);
    sums.sums[third_sum].clear();
    EXPECT_THROW(compare(sums, exact), std::logic_error);
}

TEST(Agreement, FitsAreComparedErrorByError) {
    EXPECT_EQ(fit_difference({4, 2, 1}, {4, 2, 1}), 0);
    EXPECT_NEAR(fit_difference({4, 2.002, 1}, {4, 2, 1}), 1e-3, 1e-12);
    EXPECT_EQ(fit_difference({4, 2}, {4, 2, 1}), HUGE_VAL);
    EXPECT_EQ(fit_difference({4, NAN, 1}, {4, 2, 1}), HUGE_VAL);
    EXPECT_EQ(fit_difference({NAN, 2, 1}, {4, 2, 1}), HUGE_VAL);
    Checked checked{.scene = "star", .device = Device::compute, .fit_difference = 1e-3, .fit_tolerance = 1e-4};
    EXPECT_EQ(checked.disagreement(), "errors of 3 iterations off by 1.0e-03");
    checked.fit_difference = 1e-5;
    EXPECT_EQ(checked.disagreement(), "");
    checked.failure = "no memory";
    EXPECT_EQ(checked.disagreement(), "no memory");
}

/// A scene on the CPU, its sums right and then wrong.
void expect_checked(BenchScene& scene, bool light_field) {
    const ExactSums exact = scene.exact_sums();
    const DeviceSums right = scene.sums(Device::cpu);
    EXPECT_EQ(compare(right, exact).disagreement(), "");
    uint64_t samples = 0;
    for (const uint32_t n : exact.samples) samples += n;
    EXPECT_EQ(samples, scene.facts().site_samples);
    EXPECT_GT(samples, 1000u);
    EXPECT_EQ(exact.samples.size(), scene.facts().sites);
    EXPECT_EQ(right.sums[gradient_sum].size(), scene.facts().parameters);
    EXPECT_EQ(right.sums[fourth_sum].empty(), !light_field);
    for (size_t q = 0; q < quantity_names.size(); ++q) {
        if (right.sums[q].empty()) continue;
        // the entry whose terms are largest has a site with samples
        const auto& sums = exact.sums[q];
        size_t largest = 0;
        for (size_t i = 0; i < sums.size(); ++i)
            if (sums[i].magnitude > sums[largest].magnitude) largest = i;
        DeviceSums wrong = right;
        wrong.sums[q][largest] += float(1e-4 * sums[largest].magnitude);
        EXPECT_TRUE(says(compare(wrong, exact), quantity_names[q])) << quantity_names[q];
    }
    const auto contestant = scene.contestant(Device::cpu);
    const std::vector<double> errors = contestant->fit(BenchScene::fit_iterations), reference = scene.reference_fit();
    EXPECT_LE(fit_difference(errors, reference), scene.fit_tolerance());
    EXPECT_LT(reference.back(), reference.front());
    for (const Pass pass : {Pass::gradient, Pass::line, Pass::iteration, Pass::distribution}) {
        ASSERT_TRUE(contestant->has(pass));
        contestant->prepare(pass, 2);
        contestant->run(pass, 2);
    }
    for (const Pass pass : {Pass::gradient, Pass::line}) {
        const PassLoad load = contestant->load(pass);
        EXPECT_GT(*load.operations, 20 * double(samples));
        EXPECT_GT(*load.bytes, 8 * double(scene.facts().samples));
        EXPECT_FALSE(load.reads);
    }
    EXPECT_FALSE(contestant->load(Pass::iteration).operations);
    EXPECT_FALSE(scene.contestant(Device::one_thread)->has(Pass::distribution));
}

Dataset generated(const SyntheticOptions& options, const TemporaryFolder& folder) {
    set_quiet(true);
    generate_synthetic(options, folder.path() / options.shape);
    return open_dataset(folder.path() / options.shape);
}

TEST(Scenes, SumsOfALightFieldMapAreChecked) {
    const TemporaryFolder folder;
    expect_checked(*light_field_scene(generated({.shape = "star"}, folder), false), true);
}

TEST(Scenes, SumsOfTexelsAreChecked) {
    const TemporaryFolder folder;
    const Dataset dataset = generated({.shape = "ornament", .views = 10}, folder);
    EXPECT_EQ(dataset.views.size(), 10u);
    EXPECT_NE(dataset.source.find("of 10 images"), std::string::npos) << dataset.source;
    expect_checked(*texel_scene(dataset, false), false);
}

}  // namespace
}  // namespace radiafit

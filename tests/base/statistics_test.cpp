#include "base/statistics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/rng.h"

namespace radiafit {
namespace {

TEST(Statistics, MediansOfOddAndEvenCounts) {
    EXPECT_EQ(median({3}), 3);
    EXPECT_EQ(median({5, 1}), 3);
    EXPECT_EQ(median({9, 1, 2}), 2);
    EXPECT_EQ(median({4, 1, 3, 2}), 2.5);
    EXPECT_TRUE(std::isnan(median({})));
}

// numpy.quantile([1, 2, 4, 8, 16], q) says the same.
TEST(Statistics, QuantilesLieLinearlyBetweenNeighbours) {
    const std::vector<double> values = {8, 1, 16, 4, 2};
    for (const auto& [q, expected] :
         {std::pair{0.0, 1.0}, {0.1, 1.4}, {0.25, 2.0}, {0.6, 5.6}, {0.9, 12.8}, {1.0, 16.0}})
        EXPECT_NEAR(quantile(values, q), expected, 1e-12) << q;
}

TEST(Statistics, QuantilesOfManyAreThoseOfTheSortedValues) {
    Rng rng(3);
    std::vector<double> values(1001);
    for (double& x : values) x = std::floor(50 * rng.uniform());  // with ties
    std::vector<double> sorted = values;
    std::sort(sorted.begin(), sorted.end());
    for (size_t i = 0; i < sorted.size(); i += 7) EXPECT_EQ(quantile(values, double(i) / 1000), sorted[i]);
}

TEST(Statistics, TheRatioOfMediansLiesWhereItsSpreadSays) {
    const std::vector<double> ones = {1, 1, 1, 1, 1};
    EXPECT_EQ(ratio_of_medians({3, 3, 3}, ones).low, 3);
    EXPECT_EQ(ratio_of_medians({3, 3, 3}, ones).high, 3);
    const Interval wide = ratio_of_medians({1, 2, 3, 4, 5}, ones);
    EXPECT_EQ(wide.low, 1);
    EXPECT_EQ(wide.high, 5);
    const Interval narrow = ratio_of_medians({1, 2, 3, 4, 5}, ones, 0.5);
    EXPECT_EQ(narrow.low, 2);
    EXPECT_EQ(narrow.high, 4);
}

// Of 400 pairs of samples of one distribution: how many intervals of 99 % leave out the ratio, 1. Of so few values a
// few more than one in a hundred do.
TEST(Statistics, AnIntervalHoldsTheTruthAsOftenAsItSays) {
    Rng rng(8);
    int missed = 0;
    for (int trial = 0; trial < 400; ++trial) {
        std::vector<double> a(8), b(8);
        for (auto* side : {&a, &b})
            for (double& x : *side)
                x = 1 + 0.1 * std::sqrt(-2 * std::log(1 - rng.uniform())) * std::cos(6.2831853 * rng.uniform());
        const Interval interval = ratio_of_medians(a, b);
        missed += interval.low > 1 || interval.high < 1;
    }
    EXPECT_GE(missed, 1);
    EXPECT_LE(missed, 12);
}

double normal(Rng& rng) { return std::sqrt(-2 * std::log(1 - rng.uniform())) * std::cos(6.2831853 * rng.uniform()); }

TEST(Statistics, TheMediansIntervalIsBetweenOrderStatistics) {
    EXPECT_FALSE(median_interval({1, 2, 3, 4, 5}, 5)) << "1 to 5 holds it in 15 of 16 draws";
    const auto six = median_interval({6, 1, 5, 2, 4, 3}, 6);
    ASSERT_TRUE(six);
    EXPECT_EQ(six->low, 1);
    EXPECT_EQ(six->high, 6);
    const auto nine = median_interval({9, 8, 7, 6, 5, 4, 3, 2, 1}, 9);
    ASSERT_TRUE(nine);
    EXPECT_EQ(nine->low, 2);
    EXPECT_EQ(nine->high, 8);
    std::vector<double> many(30000);
    for (size_t i = 0; i < many.size(); ++i) many[i] = double(i) / double(many.size() - 1);
    const auto of_all = median_interval(many, many.size());
    ASSERT_TRUE(of_all);
    EXPECT_NEAR(of_all->high - 0.5, 1.96 * 0.5 / std::sqrt(30000.0), 1e-4);
    EXPECT_NEAR(of_all->low + of_all->high, 1, 1e-9);
    const auto thirds = median_interval(many, many.size() / 3);
    ASSERT_TRUE(thirds);
    EXPECT_NEAR(thirds->high - 0.5, 1.96 * 0.5 / std::sqrt(10000.0), 2e-4);
}

// Of n values, the quartile lies between the i-th and the j-th with the probability that i to j - 1 of n lie below it.
TEST(Statistics, AQuantilesIntervalIsBetweenOrderStatistics) {
    std::vector<double> values(20);
    for (size_t i = 0; i < values.size(); ++i) values[i] = double(i + 1);
    // Binomial(20, 1/4): P(X <= 1) = 0.0243, P(X <= 2) = 0.0913; P(X >= 9) = 0.0409, P(X >= 10) = 0.0139.
    const auto quartile = quantile_interval(values, 0.25, 20);
    ASSERT_TRUE(quartile);
    EXPECT_NEAR(quartile->low, 2, 1e-9);
    EXPECT_NEAR(quartile->high, 10, 1e-9);
    const auto upper = quantile_interval(values, 0.75, 20);
    ASSERT_TRUE(upper);
    EXPECT_NEAR(upper->low, 11, 1e-9);
    EXPECT_NEAR(upper->high, 19, 1e-9);
    EXPECT_FALSE(quantile_interval({1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12}, 0.25, 12)) << "0.75^12 = 3.2 %";
    const auto surer = quantile_interval(values, 0.5, 20, 0.99);
    EXPECT_LT(surer->low, median_interval(values, 20)->low);
}

TEST(Statistics, WilsonsIntervalOfAShare) {
    EXPECT_FALSE(share_interval(0, 0));
    // Brown, Cai and DasGupta 2001: none of ten, z = 1.96, gives 0 to 0.278.
    EXPECT_NEAR(share_interval(0, 10)->high, 0.2775, 1e-3);
    EXPECT_EQ(share_interval(0, 10)->low, 0);
    EXPECT_NEAR(share_interval(0.5, 100)->low, 0.4038, 1e-4);
    EXPECT_NEAR(share_interval(0.5, 100)->high, 0.5962, 1e-4);
}

TEST(Statistics, StudentsIntervalOfAMean) {
    EXPECT_FALSE(mean_interval({1}));
    // Mean 2, standard deviation 1: 4.303 / sqrt(3) to either side.
    EXPECT_NEAR(mean_interval({1, 2, 3})->low, 2 - 2.4843, 1e-3);
    EXPECT_NEAR(mean_interval({1, 2, 3})->high, 2 + 2.4843, 1e-3);
}

// Of 2000 samples each, about 100 intervals may leave out the truth.
TEST(Statistics, Of95PercentIntervals95PercentHoldTheTruth) {
    Rng rng(11);
    int median_missed = 0, mean_missed = 0, share_missed = 0;
    const auto misses = [](const std::optional<Interval>& i, double truth) {
        return i->low > truth || i->high < truth;
    };
    for (int trial = 0; trial < 2000; ++trial) {
        std::vector<double> values(9);
        for (double& x : values) x = normal(rng);
        median_missed += misses(median_interval(values, 9), 0);
        values.resize(3);
        mean_missed += misses(mean_interval(values), 0);
        int hits = 0;
        for (int i = 0; i < 60; ++i) hits += rng.uniform() < 0.3;
        share_missed += misses(share_interval(hits / 60.0, 60), 0.3);
    }
    EXPECT_LT(median_missed, 110);
    EXPECT_NEAR(mean_missed, 100, 35);
    EXPECT_NEAR(share_missed, 100, 40);
}

}  // namespace
}  // namespace radiafit

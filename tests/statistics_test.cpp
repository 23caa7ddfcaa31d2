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

}  // namespace
}  // namespace radiafit

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

}  // namespace
}  // namespace radiafit

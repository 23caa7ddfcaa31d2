#include "page/performance_profile.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace radiafit {
using namespace harness;
namespace {

TEST(PerformanceProfile, SharesWithinFactorsOfTheFastest) {
    // Four problems: the third is solved by nobody, the last was not tried by b.
    const auto profiles = performance_profiles({{"a", {1, 4, INFINITY, 5}}, {"b", {3, 2, INFINITY, NAN}}});
    ASSERT_EQ(profiles.size(), 2U);
    EXPECT_EQ(profiles[0].solver, "a");
    EXPECT_EQ(profiles[0].tried, 4U);
    EXPECT_EQ(profiles[0].ratios, (std::vector<double>{1, 1, 2}));
    EXPECT_EQ(profiles[0].share_within(1), 0.5);
    EXPECT_EQ(profiles[0].share_within(1.99), 0.5);
    EXPECT_EQ(profiles[0].share_within(2), 0.75);
    EXPECT_EQ(profiles[1].tried, 3U);
    EXPECT_EQ(profiles[1].share_within(1), 1 / 3.0);
    EXPECT_EQ(profiles[1].share_within(3), 2 / 3.0);
    EXPECT_EQ(profiles[1].share_within(INFINITY), 2 / 3.0) << "solved at all";
}

TEST(PerformanceProfile, NoTimeAtAllIsTheFastest) {
    const auto profiles = performance_profiles({{"a", {0}}, {"b", {0}}, {"c", {1}}});
    EXPECT_EQ(profiles[0].share_within(1), 1);
    EXPECT_EQ(profiles[1].share_within(1), 1);
    EXPECT_EQ(profiles[2].share_within(1e9), 0);
    EXPECT_EQ(profiles[2].share_within(INFINITY), 1);
}

TEST(PerformanceProfile, WhatCannotBeComparedIsRefused) {
    EXPECT_THROW(performance_profiles({{"a", {1, 2}}, {"b", {1}}}), std::logic_error);
    EXPECT_THROW(performance_profiles({{"a", {-1}}}), std::logic_error);
    EXPECT_TRUE(performance_profiles({}).empty());
}

}  // namespace
}  // namespace radiafit

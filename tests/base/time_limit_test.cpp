// Rounds that end in time.
#include "base/time_limit.h"

#include <gtest/gtest.h>

#include <chrono>
#include <limits>
#include <thread>

namespace radiafit {
namespace {

int rounds_of(int wanted, int milliseconds) {
    int done = 0;
    for (; another_round(done, wanted); ++done) std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
    return done;
}

TEST(TimeLimit, WhatIsComparedComesFirstThenWhatIsQuick) {
    const auto chosen = [](std::vector<InRound> all, double seconds) { return those_in_time(all, seconds); };
    using Chosen = std::vector<bool>;
    const std::vector<InRound> all = {{false, 1}, {true, 4}, {false, 2}, {true, 3}};
    EXPECT_EQ(chosen(all, std::numeric_limits<double>::infinity()), Chosen({true, true, true, true}));
    EXPECT_EQ(chosen(all, 10), Chosen({true, true, true, true}));
    EXPECT_EQ(chosen(all, 9), Chosen({true, true, false, true}));
    EXPECT_EQ(chosen(all, 7), Chosen({false, true, false, true}));
    EXPECT_EQ(chosen(all, 8), Chosen({true, true, false, true}));
    EXPECT_EQ(chosen(all, 0), Chosen({false, true, false, true})) << "who is compared is in every round";
    EXPECT_EQ(chosen({}, 1), Chosen());
}

// In one test, since limits are the process's.
TEST(TimeLimit, EveryLoopHasItsShareAndOneRoundAtLeast) {
    EXPECT_EQ(rounds_of(5, 1), 5);
    EXPECT_FALSE(rounds_left_out());
    EXPECT_FALSE(time_is_limited());
    EXPECT_EQ(seconds_left(), std::numeric_limits<double>::infinity());
    limit_time(0.6 / 60);
    EXPECT_TRUE(time_is_limited());
    share_time(2);
    const int first = rounds_of(1000, 20);  // of 0.3 s
    EXPECT_GT(first, 1);
    EXPECT_LE(first, 15);
    EXPECT_TRUE(rounds_left_out());
    EXPECT_LT(seconds_left(), 0.03);
    const int second = rounds_of(1000, 20);
    EXPECT_GT(second, 1);
    EXPECT_LE(first + second, 30);
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    EXPECT_EQ(rounds_of(1000, 1), 1);  // too late
    limit_time(1);
    EXPECT_TRUE(another_round(0, 9));
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    EXPECT_TRUE(another_round(1, 9, 50));
    EXPECT_FALSE(another_round(1, 9, 70)) << "of which 60 are left";
}

}  // namespace
}  // namespace radiafit

// Rounds that end in time.
#include "base/time_limit.h"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>

namespace radiafit {
namespace {

int rounds_of(int wanted, int milliseconds) {
    int done = 0;
    for (; another_round(done, wanted); ++done) std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
    return done;
}

// In one test, since limits are the process's.
TEST(TimeLimit, EveryLoopHasItsShareAndOneRoundAtLeast) {
    EXPECT_EQ(rounds_of(5, 1), 5);
    EXPECT_FALSE(rounds_left_out());
    limit_time(0.6 / 60);
    share_time(2);
    const int first = rounds_of(1000, 20);  // of 0.3 s
    EXPECT_GT(first, 1);
    EXPECT_LE(first, 15);
    EXPECT_TRUE(rounds_left_out());
    const int second = rounds_of(1000, 20);
    EXPECT_GT(second, 1);
    EXPECT_LE(first + second, 30);
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    EXPECT_EQ(rounds_of(1000, 1), 1);  // too late
}

}  // namespace
}  // namespace radiafit

// How long tasks will still take, from made times.
#include "base/forecast.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/rng.h"

namespace radiafit {
namespace {

struct MadePart {
    size_t steps;
    double seconds;  ///< of a step, as expected
};

/// Steps take `factor` times what was expected, each up to `noise` more or less, and so do parts. From the
/// first tenth of all on, what is left is within 30 % of the truth.
void expect_true_from_the_first_tenth(const std::vector<MadePart>& parts, double factor, double noise, uint64_t seed) {
    Rng rng(seed);
    const auto about_one = [&](double spread) { return 1 + spread * (2 * double(rng.uniform()) - 1); };
    Forecast forecast;
    std::vector<std::vector<double>> times;
    double all = 0;
    for (const MadePart& part : parts) {
        forecast.add(part.steps, part.seconds);
        times.emplace_back();
        const double off = factor * about_one(0.15);
        for (size_t i = 0; i < part.steps; ++i) {
            times.back().push_back(off * about_one(noise) * part.seconds);
            all += times.back().back();
        }
    }
    double passed = 0;
    for (size_t p = 0; p < parts.size(); ++p)
        for (const double seconds : times[p]) {
            if (passed >= 0.1 * all) {
                EXPECT_NEAR(forecast.seconds_left() / (all - passed), 1, 0.3)
                    << "at " << passed << " of " << all << ", factor " << factor << ", seed " << seed;
            }
            forecast.took(p, 1, seconds);
            passed += seconds;
        }
    EXPECT_NEAR(forecast.seconds_left(), 0, 1e-9);
}

TEST(Forecast, IsTrueFromTheFirstTenthOn) {
    // As publish has it: pictures, effects, a trial, comparisons, maps, judged views; and as render has.
    const std::vector<MadePart> page = {{16, 1.6}, {29, 0.3}, {1, 3}, {16, 0.9}, {31, 0.8}, {45, 0.7}};
    for (const double factor : {0.3, 1.0, 4.0})
        for (uint64_t seed = 0; seed < 20; ++seed) {
            expect_true_from_the_first_tenth(page, factor, 0.1, seed);
            expect_true_from_the_first_tenth({{90, 0.4}}, factor, 0.1, seed);
        }
}

TEST(Forecast, BeginsWithWhatIsExpectedAndKnowsOfMoreSteps) {
    Forecast forecast;
    const size_t first = forecast.add(10, 2), second = forecast.add(4, 5);
    EXPECT_DOUBLE_EQ(forecast.seconds_left(), 40);
    forecast.took(first, 5, 20);  // twice as long, and so is all that comes
    EXPECT_DOUBLE_EQ(forecast.seconds_left(), 5 * 4 + 4 * 10);
    forecast.took(first, 5, 20);
    forecast.took(second, 1, 7);
    EXPECT_DOUBLE_EQ(forecast.seconds_left(), 3 * 7);
    forecast.add_steps(second, 2);
    EXPECT_DOUBLE_EQ(forecast.seconds_left(), 5 * 7);
    forecast.took(second, 6, 42);  // more than there were
    EXPECT_EQ(forecast.seconds_left(), 0);
}

TEST(Forecast, WhatIsLeftIsNeverNothing) {
    EXPECT_EQ(duration(0.01), "0:01");
    EXPECT_EQ(duration(0), "0:00");
    EXPECT_EQ(duration(129.6), "2:10");
    EXPECT_NE(progress_bar("fit", 999, 1000, 2, 80).find("0:01 left"), std::string::npos);
    EXPECT_EQ(progress_bar("publish", 500, 1000, 8, 80, false),
              "publish  [####################....................]  50%  0:08 left");
}

}  // namespace
}  // namespace radiafit

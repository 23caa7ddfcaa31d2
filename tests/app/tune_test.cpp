// Which of the settings that a search tried is recommended, by made errors.
#include "fitting/tune.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/rng.h"

namespace radiafit {
using namespace fits;
namespace {

/// Errors of some views, each `ratio` times what views have anyway, give or take `noise`.
TriedSetting tried(size_t numbers, int views, double ratio, double noise, uint64_t seed = 0) {
    TriedSetting t;
    t.numbers = numbers;
    Rng of_view(7), own(seed + numbers);
    for (int i = 0; i < views; ++i) {
        const double mean = 0.001 * (1 + 9 * double(of_view.uniform()));  // views differ much more than settings
        ErrorSums sums;
        sums.squared = mean * ratio * (1 + noise * (2 * double(own.uniform()) - 1));
        sums.values = 1;
        t.errors.push_back(sums);
    }
    return t;
}

TEST(Tune, ABetterSettingIsWorthItsNumbers) {
    // 0.2 dB in every view, however different these are from each other
    EXPECT_EQ(smallest_as_good({tried(400, 12, 0.955, 0.01), tried(100, 12, 1, 0.01)}), 0u);
    EXPECT_EQ(smallest_as_good({tried(400, 12, 0.955, 0.01)}), 0u);
}

TEST(Tune, WithinTheNoiseOfItsViewsTheSmallestWins) {
    // 0.04 dB in the mean, and a view's error is off by some percent
    int smallest = 0;
    for (uint64_t seed = 0; seed < 100; ++seed)
        smallest += smallest_as_good({tried(400, 12, 0.995, 0.1, seed), tried(200, 12, 0.998, 0.1, seed),
                                      tried(100, 12, 1, 0.1, seed), tried(50, 12, 1.5, 0.1, seed)}) == 2;
    EXPECT_GE(smallest, 85);  // a bootstrap of so few views is a little too certain
    // Alike, it is the smaller one; and of two of one size the better.
    EXPECT_EQ(smallest_as_good({tried(400, 4, 1, 0), tried(100, 4, 1, 0)}), 1u);
    EXPECT_EQ(smallest_as_good({tried(100, 12, 0.995, 0.1), tried(100, 12, 1, 0.1, 3), tried(400, 12, 1, 0.1)}), 0u);
}

TEST(Tune, TwiceTheNumbersForNextToNothingAreNotWorthIt) {
    // 0.04 dB in every view, beyond all noise: twice the numbers should bring 0.05 dB, of a tenth more any gain counts
    const double ratio = std::pow(10, -0.004);
    EXPECT_EQ(smallest_as_good({tried(200, 12, ratio, 0), tried(100, 12, 1, 0)}), 1u);
    EXPECT_EQ(smallest_as_good({tried(110, 12, ratio, 0), tried(100, 12, 1, 0)}), 0u);
}

TEST(Tune, WhatAModelDoesOffThePhotographsCountsAsMuch) {
    const auto of = [](const char* model, size_t numbers, double ratio, std::optional<double> off) {
        TriedSetting t = tried(numbers, 12, ratio, 0);
        t.setting = {{"model", model}};
        t.psnr = 25 - 10 * std::log10(ratio);
        t.off_psnr = off;
        return t;
    };
    // a tenth of a decibel amid the photographs against half a decibel off them, and the other way about
    EXPECT_EQ(recommended_of({of("viewbasis", 50, 1, 22), of("viewbasis", 60, 1.01, {}), of("sg", 60, 1.02, 22.5)}),
              2u);
    EXPECT_EQ(recommended_of({of("viewbasis", 50, 1, 22.5), of("sg", 60, 1.02, 22)}), 0u);
    // Of the chosen model it is the smallest that is as good.
    EXPECT_EQ(recommended_of({of("lfm", 10, 1, 20), of("sg", 400, 1.001, 22), of("sg", 100, 1.002, {})}), 2u);
    // Nothing is weighed where one model alone was.
    EXPECT_EQ(recommended_of({of("viewbasis", 50, 1, 22), of("sg", 60, 1.02, {})}), 0u);
}

}  // namespace
}  // namespace radiafit

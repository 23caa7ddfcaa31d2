// Packs: exp and log against double over all they are made for, lanes apart, NaN kept.
#include "base/pack.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>

#include "base/flush_subnormals.h"
#include "base/rng.h"

namespace radiafit {
namespace {

constexpr float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();

Pack of(const float (&x)[8]) {
    Pack out;
    for (int lane = 0; lane < 8; ++lane) out.set(lane, x[lane]);
    return out;
}
/// Error in units in the last place of the exact value.
double ulps(float value, double exact) {
    return std::abs(double(value) - exact) / std::ldexp(1.0, std::ilogb(exact) - 23);
}

TEST(Pack, ExpIsWithinTwoUnitsInTheLastPlace) {
    for (int i = 0; i < 4000000; i += 8) {
        float x[8];
        for (int lane = 0; lane < 8; ++lane) x[lane] = -87.33f + 175.7f * float(i + lane) / 4000000.0f;
        const Pack y = exp(of(x));
        for (int lane = 0; lane < 8; ++lane) ASSERT_LE(ulps(y[lane], std::exp(double(x[lane]))), 2) << x[lane];
    }
}

TEST(Pack, LogIsWithinTwoUnitsInTheLastPlace) {
    for (uint32_t bits = 0x00800000; bits < 0x7f000000; bits += 8 * 577) {
        float x[8];
        for (uint32_t lane = 0; lane < 8; ++lane) x[lane] = std::bit_cast<float>(bits + 577 * lane);
        const Pack y = log(of(x));
        for (int lane = 0; lane < 8; ++lane) ASSERT_LE(ulps(y[lane], std::log(double(x[lane]))), 2) << x[lane];
    }
    for (int i = -100; i <= 100; ++i) {  // where ln x is small
        const float x = 1 + float(i) * 0x1p-23f;
        ASSERT_EQ(i == 0, log(Pack(x))[0] == 0);
        if (i) {
            ASSERT_LE(ulps(log(Pack(x))[0], std::log(double(x))), 2) << i;
        }
    }
}

TEST(Pack, ExpStaysFiniteAndKeepsNaN) {
    const float x[] = {-infinity, -1000, -88, 0, 88.5f, 1000, infinity, nan};
    const Pack y = exp(of(x));
    for (int lane = 0; lane < 7; ++lane) {
        EXPECT_GE(y[lane], std::numeric_limits<float>::min()) << lane;
        EXPECT_LE(y[lane], std::numeric_limits<float>::max()) << lane;
    }
    EXPECT_EQ(y[3], 1);
    EXPECT_LT(y[0], 1.3e-38f);
    EXPECT_GT(y[6], 2e38f);
    EXPECT_TRUE(std::isnan(y[7]));
}

TEST(Pack, ArithmeticIsThatOfEachLane) {
    Rng rng(1);
    for (int trial = 0; trial < 1000; ++trial) {
        float a[8], b[8];
        for (int lane = 0; lane < 8; ++lane) a[lane] = rng.uniform(-2, 2), b[lane] = rng.uniform(-2, 2);
        const Pack x = of(a), y = of(b);
        const Pack sum = x + y, product = x * y, ratio = x / y, smaller = min(x, y), larger = max(x, y);
        const Pack chosen = Pack::select(x < y, x - y, -x);
        for (int lane = 0; lane < 8; ++lane) {
            EXPECT_EQ(sum[lane], a[lane] + b[lane]);
            EXPECT_EQ(product[lane], a[lane] * b[lane]);
            EXPECT_EQ(ratio[lane], a[lane] / b[lane]);
            EXPECT_EQ(smaller[lane], std::min(a[lane], b[lane]));
            EXPECT_EQ(larger[lane], std::max(a[lane], b[lane]));
            EXPECT_EQ(chosen[lane], a[lane] < b[lane] ? a[lane] - b[lane] : -a[lane]);
            EXPECT_EQ(narrow(widen(x))[lane], a[lane]);
        }
    }
    EXPECT_TRUE(std::isnan(max(Pack(nan), Pack(1.0f))[0])) << "as std::max";
    EXPECT_EQ(max(Pack(1.0f), Pack(nan))[0], 1) << "as std::max";
}

TEST(FlushSubnormals, LastsAsLongAsItLives) {
    volatile float small = 1e-30f;
    {
        const FlushSubnormals flush;
#if defined(__SSE__)
        EXPECT_EQ(small * small * 1e15f, 0);
        volatile float product = small * 1e-10f;
        EXPECT_EQ(product, 0);
#endif
    }
    volatile float product = small * 1e-10f;
    EXPECT_GT(product, 0);
}

}  // namespace
}  // namespace radiafit

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

template <class real>
class Packs : public testing::Test {};
using Reals = testing::Types<float, double>;
TYPED_TEST_SUITE(Packs, Reals);

TYPED_TEST(Packs, ArithmeticIsThatOfEachLane) {
    using real = TypeParam;
    using Many = PackOf<real>;
    Rng rng(1);
    for (int trial = 0; trial < 1000; ++trial) {
        real a[8], b[8];
        Many x, y;
        for (int lane = 0; lane < 8; ++lane) {
            a[lane] = real(rng.uniform(-2, 2)), b[lane] = lane == trial % 8 ? a[lane] : real(rng.uniform(-2, 2));
            x.set(lane, a[lane]), y.set(lane, b[lane]);
        }
        const Many sum = x + y, product = x * y, ratio = x / y, smaller = min(x, y), larger = max(x, y);
        const Many chosen = Many::select(x < y, x - y, -x), present = select_nonzero(x - y, x, Many(real(7)));
        Many added = x;
        added += y, added *= y, added -= x;
        const PairLanes<real> joined = x.joined();
        for (int lane = 0; lane < 8; ++lane) {
            EXPECT_EQ(joined[lane], a[lane]);
            EXPECT_EQ(Many(joined)[lane], a[lane]);
            EXPECT_EQ(added[lane], (a[lane] + b[lane]) * b[lane] - a[lane]);
            EXPECT_EQ(present[lane], a[lane] == b[lane] ? real(7) : a[lane]);
            EXPECT_EQ((x < y)[lane], a[lane] < b[lane]);
            EXPECT_EQ((x <= y)[lane], a[lane] <= b[lane]);
            EXPECT_EQ((x > y)[lane], a[lane] > b[lane]);
            EXPECT_EQ((x >= y)[lane], a[lane] >= b[lane]);
            EXPECT_EQ(((x < y) & (x > Many(real(0))))[lane], a[lane] < b[lane] && a[lane] > 0);
            EXPECT_EQ(((x < y) | (x > Many(real(0))))[lane], a[lane] < b[lane] || a[lane] > 0);
            EXPECT_EQ(sum[lane], a[lane] + b[lane]);
            EXPECT_EQ(product[lane], a[lane] * b[lane]);
            EXPECT_EQ(ratio[lane], a[lane] / b[lane]);
            EXPECT_EQ(smaller[lane], std::min(a[lane], b[lane]));
            EXPECT_EQ(larger[lane], std::max(a[lane], b[lane]));
            EXPECT_EQ(chosen[lane], a[lane] < b[lane] ? a[lane] - b[lane] : -a[lane]);
        }
    }
}

TYPED_TEST(Packs, NanIsAsTheStandardLibraryHasIt) {
    using Many = PackOf<TypeParam>;
    const Many one(TypeParam(1));
    for (const int lane : {0, 2, 5, 7}) {
        Many x = one;
        x.set(lane, nan);
        for (int i = 0; i < 8; ++i) {
            EXPECT_EQ(std::isnan(max(x, one)[i]), i == lane);
            EXPECT_EQ(std::isnan(min(x, one)[i]), i == lane);
            EXPECT_EQ(max(one, x)[i], 1);
            EXPECT_EQ(min(one, x)[i], 1);
            EXPECT_FALSE((x < one)[i]);
            EXPECT_FALSE((x > one)[i]);
            EXPECT_EQ((x <= one)[i], i != lane);
            EXPECT_EQ((x >= one)[i], i != lane);
        }
    }
}

TYPED_TEST(Packs, TruthsAreSetLaneByLane) {
    using Many = PackOf<TypeParam>;
    const Many one(TypeParam(1)), two(TypeParam(2));
    for (int lane = 0; lane < 8; ++lane) {
        auto truths = two < one;
        truths.set(lane, true);
        for (int i = 0; i < 8; ++i) EXPECT_EQ(Many::select(truths, one, two)[i], i == lane ? 1 : 2);
        truths.set(lane, false);
        EXPECT_FALSE(truths[lane]);
    }
}

TEST(Pack, NarrowUndoesWiden) {
    const float x[] = {1, -2, 3.5f, 1e-20f, 5, 6e20f, -7, 0.1f};
    for (int lane = 0; lane < 8; ++lane) {
        EXPECT_EQ(widen(of(x))[lane], double(x[lane]));
        EXPECT_EQ(narrow(widen(of(x)))[lane], x[lane]);
    }
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

#include <gtest/gtest.h>

#include <atomic>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <mutex>
#include <set>
#include <stdexcept>
#include <thread>

#include "base/clock.h"
#include "base/error.h"
#include "base/half.h"
#include "base/hash.h"
#include "base/log.h"
#include "base/parallel.h"
#include "base/rng.h"

namespace radiafit {
namespace {

// ---- parallel ------------------------------------------------------------------------------------------------------

/// Puts the thread count back, so that tests don't meet.
struct Threads {
    explicit Threads(int count) { set_thread_count(count); }
    ~Threads() { set_thread_count(0); }
};

TEST(Parallel, EveryIndexOnceUnderAValidWorker) {
    for (const int threads : {1, 2, 3, 8}) {
        const Threads set(threads);
        ASSERT_EQ(thread_count(), threads);
        for (const size_t count : {0, 1, 2, 7, 64, 1000}) {
            for (const size_t grain : {0, 1, 3, 64, 5000}) {
                SCOPED_TRACE(testing::Message() << threads << " threads, " << count << " by " << grain);
                std::vector<std::atomic<int>> seen(count);
                std::atomic<bool> worker_valid = true;
                parallel_for(count, grain, [&](size_t i, int worker) {
                    seen[i]++;
                    if (worker < 0 || worker >= threads) worker_valid = false;
                });
                for (const auto& times : seen) ASSERT_EQ(times, 1);
                EXPECT_TRUE(worker_valid);
            }
        }
    }
}

TEST(Parallel, ChunksAreTheGrainAndTheLastIsTheRest) {
    const Threads set(3);
    std::mutex mutex;
    std::set<std::pair<size_t, size_t>> chunks;
    parallel_chunks(10, 4, [&](size_t begin, size_t end, int) {
        const std::scoped_lock lock(mutex);
        chunks.insert({begin, end});
    });
    EXPECT_EQ(chunks, (std::set<std::pair<size_t, size_t>>{{0, 4}, {4, 8}, {8, 10}}));
}

TEST(Parallel, WorkersDoWorkAtTheSameTime) {
    const Threads set(2);
    // Both bodies wait for each other: with one thread alone this would hang, so there is a limit.
    std::atomic<int> arrived = 0;
    std::atomic<bool> met = true;
    parallel_for(2, 1, [&](size_t, int) {
        arrived++;
        const Stopwatch watch;
        while (arrived < 2 && watch.wall_s() < 20) std::this_thread::yield();
        if (arrived < 2) met = false;
    });
    EXPECT_TRUE(met);
}

TEST(Parallel, NoWorkerIndexIsUsedTwiceAtOnceEvenWhenNested) {
    const Threads set(4);
    std::vector<std::atomic<int>> inside(4);
    std::atomic<int> inner_calls = 0;
    std::atomic<bool> kept = true;
    std::atomic<int> arrived = 0;
    parallel_for(64, 1, [&](size_t, int worker) {
        arrived++;  // no body ends before all four workers are inside one, so that worker 0 can't do it all
        const Stopwatch watch;
        while (arrived < 4 && watch.wall_s() < 20) std::this_thread::yield();
        if (inside[static_cast<size_t>(worker)]++ != 0) kept = false;
        parallel_for(5, 1, [&](size_t, int inner) {
            inner_calls++;
            if (inner != worker) kept = false;
        });
        inside[static_cast<size_t>(worker)]--;
    });
    EXPECT_EQ(inner_calls, 64 * 5);
    EXPECT_TRUE(kept);
}

TEST(Parallel, AnExceptionReachesTheCallerAndThePoolLivesOn) {
    const Threads set(3);
    for (int round = 0; round < 20; round++) {
        EXPECT_THROW(parallel_for(100, 1,
                                  [](size_t i, int) {
                                      if (i % 10 == 3) throw UserError("three");
                                  }),
                     UserError);
        std::atomic<size_t> sum = 0;
        parallel_for(100, 7, [&](size_t i, int) { sum += i; });
        ASSERT_EQ(sum, 4950u);
    }
    EXPECT_THROW(
        parallel_for(1, 1, [](size_t, int) { parallel_for(9, 1, [](size_t, int) { throw UserError("in"); }); }),
        UserError);
}

TEST(Parallel, OfSeveralExceptionsTheLowestIsTold) {
    const Threads set(4);
    for (int round = 0; round < 20; round++) {
        std::string told;
        try {
            parallel_for(4, 1, [](size_t i, int) {
                if (i < 3) std::this_thread::sleep_for(std::chrono::milliseconds(3 - i));
                throw UserError(std::to_string(i));
            });
        } catch (const UserError& error) {
            told = error.what();
        }
        ASSERT_EQ(told, "0");
    }
}

TEST(Parallel, TwoCallersDontMix) {
    const Threads set(2);
    std::atomic<bool> right = true;
    const auto caller = [&] {
        for (int round = 0; round < 200; round++) {
            std::atomic<int> calls = 0;
            parallel_for(50, 1, [&](size_t, int) { calls++; });
            if (calls != 50) right = false;
        }
    };
    std::thread other(caller);
    caller();
    other.join();
    EXPECT_TRUE(right);
}

TEST(Parallel, TheThreadCountIsGuarded) {
    EXPECT_THROW(set_thread_count(-1), std::invalid_argument);
    EXPECT_THROW(parallel_for(1, 1, [](size_t, int) { set_thread_count(2); }), std::logic_error);
    EXPECT_EQ(thread_count(), core_count());
    EXPECT_GE(core_count(), 1);
}

// ---- half ----------------------------------------------------------------------------------------------------------

/// Value of half bits by the definition of IEEE 754, in double, where all of it is exact.
double half_value(uint16_t bits) {
    const int exponent = bits >> 10 & 31;
    const int mantissa = bits & 1023;
    const double sign = bits & 0x8000 ? -1 : 1;
    if (exponent == 31) return mantissa ? std::nan("") : sign * std::numeric_limits<double>::infinity();
    if (exponent == 0) return sign * std::ldexp(mantissa, -24);
    return sign * std::ldexp(1024 + mantissa, exponent - 25);
}

/// Every half is met by its exact value, its neighbouring midpoints and those ± 1 ulp of float.
std::vector<float> rounding_probes() {
    std::vector<float> probes;
    for (uint32_t bits = 0; bits < 0x7c00; bits++) {
        const double here = half_value(static_cast<uint16_t>(bits));
        const double next = bits == 0x7bff ? 65536.0 : half_value(static_cast<uint16_t>(bits + 1));
        for (const double value : {here, (here + next) / 2}) {
            const auto exact = static_cast<float>(value);
            for (const float x : {exact, std::nextafterf(exact, 1e30f), std::nextafterf(exact, -1e30f)}) {
                probes.push_back(x);
                probes.push_back(-x);
            }
        }
    }
    for (const float x :
         {65535.996f, 65536.0f, 1e6f, std::numeric_limits<float>::max(), std::numeric_limits<float>::infinity(),
          std::numeric_limits<float>::denorm_min(), std::numeric_limits<float>::min(), 0.0f}) {
        probes.push_back(x);
        probes.push_back(-x);
    }
    return probes;
}

TEST(Half, EveryHalfIsExactAndComesBack) {
    for (uint32_t bits = 0; bits < 0x10000; bits++) {
        const auto half = static_cast<uint16_t>(bits);
        const double value = half_value(half);
        const float converted = float_from_half(half);
        if (std::isnan(value)) {
            ASSERT_TRUE(std::isnan(converted)) << std::hex << bits;
            ASSERT_TRUE(std::isnan(float_from_half(half_from_float(converted))));
            // A signalling one may come back as it was where a compiler sees both conversions.
            ASSERT_EQ(half_from_float(converted) | 0x200, half | 0x200) << "payload kept";
            continue;
        }
        ASSERT_EQ(static_cast<double>(converted), value) << std::hex << bits;
        ASSERT_EQ(std::signbit(converted), (bits & 0x8000) != 0);
        ASSERT_EQ(half_from_float(converted), half);
        ASSERT_EQ(half_from_float_truncated(converted), half);
    }
}

TEST(Half, RoundsToTheNearestAndTiesToEven) {
    for (const float x : rounding_probes()) {
        const uint16_t half = half_from_float(x);
        ASSERT_EQ((half & 0x8000) != 0, std::signbit(x)) << x;
        const uint32_t magnitude = half & 0x7fff;
        // By the definition: no other half is nearer, where the place after the largest half counts as 65536.
        const auto place = [](uint32_t bits) {
            return bits >= 0x7c00 ? 65536.0 : half_value(static_cast<uint16_t>(bits));
        };
        const double wanted = std::fabs(static_cast<double>(x));
        if (magnitude == 0x7c00) {
            ASSERT_GE(wanted, 65520.0);
            continue;
        }
        const double error = std::fabs(place(magnitude) - wanted);
        const double error_up = std::fabs(place(magnitude + 1) - wanted);
        const double error_down = magnitude == 0 ? 1e30 : std::fabs(place(magnitude - 1) - wanted);
        ASSERT_LE(error, std::min(error_up, error_down)) << x;
        if (error == error_up || error == error_down) {
            ASSERT_EQ(magnitude & 1, 0u) << x;
        }
    }
}

TEST(Half, TruncationNeverGrowsAndLosesLessThanOnePlace) {
    for (const float x : rounding_probes()) {
        const uint16_t half = half_from_float_truncated(x);
        ASSERT_EQ((half & 0x8000) != 0, std::signbit(x)) << x;
        const uint32_t magnitude = half & 0x7fff;
        if (std::isinf(x)) {
            ASSERT_EQ(magnitude, 0x7c00u);
            continue;
        }
        ASSERT_LE(magnitude, 0x7bffu) << x;
        const double wanted = std::fabs(static_cast<double>(x));
        ASSERT_LE(half_value(static_cast<uint16_t>(magnitude)), wanted) << x;
        if (magnitude < 0x7bff) {
            ASSERT_GT(half_value(static_cast<uint16_t>(magnitude + 1)), wanted) << x;
        }
    }
}

TEST(Half, NotANumberIsMadeQuietAndKeepsTheUpperPayload) {
    for (const uint32_t payload : {1u, 0x1fffu, 0x2000u, 0x3fffffu, 0x400000u, 0x7fffffu})
        for (const uint32_t sign : {0u, 0x80000000u}) {
            const auto x = std::bit_cast<float>(sign | 0x7f800000 | payload);
            const uint32_t expected = sign >> 16 | 0x7e00 | payload >> 13;
            ASSERT_EQ(half_from_float(x), expected);
            ASSERT_EQ(half_from_float_truncated(x), expected);
        }
}

// ---- random numbers ------------------------------------------------------------------------------------------------

TEST(Hash, BytesAreThePublishedFnv1a) {
    EXPECT_EQ(hash_byte_by_byte("", 0), 0xcbf29ce484222325u);
    EXPECT_EQ(hash_byte_by_byte("a", 1), 0xaf63dc4c8601ec8cu);
    EXPECT_EQ(hash_byte_by_byte("foobar", 6), 0x85944171f73967e8u);
    EXPECT_EQ(hash_byte_by_byte("bar", 3, hash_byte_by_byte("foo", 3)), 0x85944171f73967e8u);
}

TEST(Rng, GivesThePublishedSequence) {
    // The first numbers of PCG's own demonstration program (pcg32-demo, seed 42, stream 54).
    Rng rng(42, 54);
    for (const uint32_t expected : {0xa15c02b7u, 0x7b47f409u, 0xba1d3330u, 0x83d2f293u, 0xbfa4784bu, 0xcbed606eu})
        EXPECT_EQ(rng.bits(), expected);
}

TEST(Rng, UniformIsUniform) {
    Rng rng(7);
    constexpr int count = 100000;
    double sum[2] = {}, squares[2] = {};
    for (int i = 0; i < count; i++) {
        const float values[2] = {rng.uniform(), random_uniform(7, static_cast<uint64_t>(i))};
        for (int k = 0; k < 2; k++) {
            ASSERT_GE(values[k], 0.0f);
            ASSERT_LT(values[k], 1.0f);
            sum[k] += values[k];
            squares[k] += values[k] * values[k];
        }
    }
    // Five standard errors: of the mean 1/√(12 n), of the mean square √(4/45 / n).
    for (int k = 0; k < 2; k++) {
        EXPECT_NEAR(sum[k] / count, 0.5, 5 / std::sqrt(12.0 * count));
        EXPECT_NEAR(squares[k] / count, 1.0 / 3, 5 * std::sqrt(4.0 / 45 / count));
    }
    const float between = rng.uniform(-0.3f, 0.3f);
    EXPECT_GE(between, -0.3f);
    EXPECT_LT(between, 0.3f);
}

TEST(Rng, IndexHasNoBias) {
    Rng rng(3);
    constexpr uint32_t sides = 6;
    constexpr double throws_count = 60000;
    double counts[sides] = {};
    for (int i = 0; i < throws_count; i++) {
        const uint32_t side = rng.index(sides);
        ASSERT_LT(side, sides);
        counts[side]++;
    }
    double chi_square = 0;
    for (const double count : counts) chi_square += std::pow(count - throws_count / sides, 2) / (throws_count / sides);
    EXPECT_LT(chi_square, 25.7);  // 99.99% of the distribution with 5 degrees of freedom
    for (int i = 0; i < 100; i++) EXPECT_EQ(rng.index(1), 0u);
}

TEST(Rng, SeedsStreamsAndCountersDiffer) {
    std::set<uint64_t> firsts;
    for (uint64_t seed = 0; seed < 8; seed++)
        for (uint64_t stream = 0; stream < 8; stream++) {
            Rng rng(seed, stream);
            firsts.insert(uint64_t{rng.bits()} << 32 | rng.bits());
            firsts.insert(uint64_t{random_bits(seed, stream)} << 32 | random_bits(seed, stream + 100));
        }
    EXPECT_EQ(firsts.size(), 128u);
}

// ---- log and clock -------------------------------------------------------------------------------------------------

TEST(Log, QuietLeavesWarningsAndStandardOutputStaysEmpty) {
    testing::internal::CaptureStdout();
    testing::internal::CaptureStderr();
    log_info("before");
    set_quiet(true);
    log_info("hidden");
    log_warning("shown");
    set_quiet(false);
    log_info("after");
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "before\nwarning: shown\nafter\n");
    EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
}

TEST(Log, TheBarFitsItsColumns) {
    EXPECT_EQ(progress_bar("fit", 12, 24, 8, 80),
              "fit  [####################....................]  50%  12/24  0:08 left");
    EXPECT_EQ(progress_bar("fit", 30, 24, 8, 80), "fit  [########################################] 100%  24/24");
    for (int columns = 1; columns < 100; columns++)
        for (size_t done = 0; done <= 1000; done += 250)
            EXPECT_LT(progress_bar("a task with a name", done, 1000, 4000, columns).size(), size_t(columns));
}

TEST(Log, ProgressTakesStepsFromManyThreads) {
    testing::internal::CaptureStderr();
    {
        Progress progress("many", 10000);
        parallel_for(10000, 1, [&](size_t, int) { progress.advance(); });
    }
    testing::internal::GetCapturedStderr();
}

TEST(Clock, WorkTakesProcessorTimeAndSleepDoesNot) {
    Stopwatch watch;
    while (watch.cpu_s() < 0.02) {
    }
    EXPECT_GE(watch.wall_s(), 0.0199);  // one thread cannot use more than the wall's time (clocks differ by rounding)
    watch.restart();
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    EXPECT_GE(watch.wall_s(), 0.2);
    EXPECT_LT(watch.cpu_s(), 0.1);
}

}  // namespace
}  // namespace radiafit

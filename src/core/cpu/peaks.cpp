#include "cpu/peaks.h"

#include <algorithm>
#include <cstddef>
#include <vector>

#include "base/clock.h"
#include "base/instructions.h"
#include "base/parallel.h"

namespace radiafit {
namespace {

using Wide = float __attribute__((vector_size(64)));
using Narrow = float __attribute__((vector_size(32)));

/// Keeps a value that nothing else reads.
template <class T>
void keep(T& value) {
    asm volatile("" : "+m"(value) : : "memory");
}

/// Best rate of `amount` per second over repetitions of about 20 ms in all.
template <class Body>
double best_rate(double amount, const Body& body) {
    double best = 0;
    for (int i = 0; i < 8; ++i) {
        const double begin = wall_time_s();
        body();
        best = std::max(best, amount / (wall_time_s() - begin));
    }
    return best;
}

double triad() {
    const size_t count = size_t(1) << 23;  // 3 x 64 MB of doubles, beyond any cache
    std::vector<double> a(count), b(count, 1.0), c(count, 2.0);
    const auto run = [&] {
        parallel_chunks(count, 1 << 16, [&](size_t begin, size_t end, int) {
            for (size_t i = begin; i < end; ++i) a[i] = b[i] + 3.0 * c[i];
        });
        keep(a[0]);
    };
    run();
    return best_rate(24.0 * double(count), run) * 1e-9;
}

template <class Vector>
double l2_reads() {
    const size_t count = 192 * 1024 / sizeof(Vector);
    std::vector<Vector> data(count, Vector{});
    const int rounds = 200;
    const auto read_all = [&] {
        Vector total{};
        for (int r = 0; r < rounds; ++r) {
            Vector sum[8] = {};  // in registers
            for (size_t i = 0; i < count; i += 8)
                for (size_t k = 0; k < 8; ++k) sum[k] += data[i + k];
            for (const Vector& s : sum) total += s;
            keep(data[0]);
        }
        keep(total);
    };
    return best_rate(double(rounds) * double(count) * sizeof(Vector), [&] { with_widest_vectors(read_all); }) * 1e-9;
}
double l2_reads() { return run_avx512() ? l2_reads<Wide>() : l2_reads<Narrow>(); }

/// Chains of operations that don't wait for one another, as many as there are registers for. Operations done.
template <class Vector, int chains>
double multiply_and_add(int rounds) {
    constexpr int lanes = int(sizeof(Vector) / sizeof(float));
    with_widest_vectors([&] {
        Vector sum[chains];
        Vector factor, term;
        for (int i = 0; i < lanes; ++i) factor[i] = 0.999f, term[i] = 1e-3f;
        keep(factor);
        keep(term);
        for (Vector& s : sum) s = factor;
        for (int r = 0; r < rounds; ++r)
            for (Vector& s : sum) s = s * factor + term;
        for (Vector& s : sum) keep(s);
    });
    return 2.0 * lanes * chains * rounds;
}
double multiply_and_add(int rounds) {
    return run_avx512() ? multiply_and_add<Wide, 16>(rounds) : multiply_and_add<Narrow, 12>(rounds);
}

double fused() {
    const double amount = multiply_and_add(1000) * 200;
    return best_rate(amount, [&] { multiply_and_add(200'000); }) * 1e-9;
}

double fused_by_all() {
    const auto threads = size_t(thread_count());
    const double amount = multiply_and_add(1000) * 1000 * double(threads);  // longer: threads begin one after another
    return best_rate(amount, [&] { parallel_for(threads, 1, [&](size_t, int) { multiply_and_add(1'000'000); }); }) *
           1e-9;
}

}  // namespace

CpuPeaks measure_cpu_peaks() { return {triad(), l2_reads(), fused(), fused_by_all()}; }

}  // namespace radiafit

#include "bench/timing.h"

#include <algorithm>

#include "base/clock.h"
#include "base/scoped_threads.h"
#include "cpu/peaks.h"
#include "fragment/peaks.h"

namespace radiafit::harness {
namespace {

constexpr double long_enough_s = 0.02, longer_than_compiling_s = 2;
constexpr Pass all_passes[] = {Pass::gradient, Pass::line, Pass::iteration, Pass::distribution};

int threads_of(Device device) { return device == Device::one_thread ? 1 : thread_count(); }

double seconds_of(TimedDevice& contestant, Pass pass, int times) {
    contestant.prepare(pass, times);
    const Stopwatch clock;
    contestant.run(pass, times);
    return clock.wall_s();
}

void measure(Timed& timed) {
    const ScopedThreads threads(threads_of(timed.device));
    for (const auto& [pass, times] : timed.times) {
        timed.contestant->prepare(pass, times);
        const double streamed = timed.contestant->streaming_s();
        const Stopwatch clock;
        timed.contestant->run(pass, times);
        const double seconds = clock.wall_s();
        Series& series = timed.series[pass];
        series.seconds.push_back(seconds / times);
        series.streaming_s.push_back((timed.contestant->streaming_s() - streamed) / times);
    }
}

DevicePeaks peaks_of(Device device) {
    const ScopedThreads threads(threads_of(device));
    if (!needs_opengl(device)) {
        const CpuPeaks peaks = measure_cpu_peaks();
        return {.operations = 1e9 * peaks.all_fma_gflop_s, .bytes = 1e9 * peaks.triad_gb_s};
    }
    if (units_of(device) == Device::compute) {
        const ComputePeaks peaks = measure_compute_peaks();
        return {.operations = peaks.operations_s, .bytes = peaks.bytes_s};
    }
    const GlPeaks peaks = measure_gl_peaks();
    return {peaks.operations_s, peaks.reads_s, peaks.bytes_s};
}

}  // namespace

Peaks measure_peaks(const std::vector<Device>& devices) {
    Peaks peaks;
    for (const Device device : devices) {
        const auto same = peaks.find(units_of(device));
        peaks[device] = same != peaks.end() ? same->second : peaks_of(device);
    }
    return peaks;
}

void warm_up(Timed& timed) {
    const ScopedThreads threads(threads_of(timed.device));
    for (const Pass pass : all_passes) {
        if (!timed.contestant->has(pass)) continue;
        int& times = timed.times[pass] = 1;
        if (seconds_of(*timed.contestant, pass, 1) > longer_than_compiling_s) continue;
        while (times < TimedDevice::most_times && seconds_of(*timed.contestant, pass, times) < long_enough_s)
            times *= 2;
    }
}

void measure_round(std::vector<Timed>& all) {
    for (Timed& timed : all) measure(timed);
}

}  // namespace radiafit::harness

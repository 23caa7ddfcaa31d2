#include "base/clock.h"

#include <ctime>

namespace radiafit {
namespace {

double seconds_of(clockid_t clock) {
    timespec time{};
    clock_gettime(clock, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

}  // namespace

double wall_time_s() { return seconds_of(CLOCK_MONOTONIC); }
double cpu_time_s() { return seconds_of(CLOCK_PROCESS_CPUTIME_ID); }

void Stopwatch::restart() {
    wall_start_s_ = wall_time_s();
    cpu_start_s_ = cpu_time_s();
}

double Stopwatch::wall_s() const { return wall_time_s() - wall_start_s_; }
double Stopwatch::cpu_s() const { return cpu_time_s() - cpu_start_s_; }

}  // namespace radiafit

#pragma once

/// The two clocks of every report: what the user waited, and what the machine worked.
namespace radiafit {

/// Seconds of a steady clock whose origin is arbitrary; only differences mean anything.
double wall_time_s();

/// Seconds of processor time spent by all threads of this process (llvmpipe's rasterizer threads among them).
double cpu_time_s();

/// Runs from its construction, or from the last restart.
class Stopwatch {
public:
    Stopwatch() { restart(); }
    void restart();
    double wall_s() const;
    double cpu_s() const;

private:
    double wall_start_s_ = 0;
    double cpu_start_s_ = 0;
};

}  // namespace radiafit

#pragma once

namespace radiafit {

/// What this machine can do at most, measured: the yardsticks of reported utilization.
struct CpuPeaks {
    double triad_gb_s = 0;       ///< main memory: a[i] = b[i] + s c[i], 24 bytes an element, all threads
    double l2_gb_s = 0;          ///< reads that stay in one core's L2
    double fma_gflop_s = 0;      ///< single precision multiply-adds of one core, two operations each
    double all_fma_gflop_s = 0;  ///< of all threads
};
/// About 0.4 s; the best of several repetitions each.
CpuPeaks measure_cpu_peaks();

}  // namespace radiafit

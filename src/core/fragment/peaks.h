#pragma once

namespace radiafit {

/// What the fragment stage of the current context can do at most, measured: the yardsticks of utilization. Operations,
/// reads and bytes are those that fragment/pass_costs.h counts.
struct GlPeaks {
    double operations_s = 0;  ///< per second: multiply-adds in registers, two each
    double reads_s = 0;       ///< texels of 16 bytes that caches hold
    double bytes_s = 0;       ///< the device's memory: 64 MB (on a chip 256 MB) copied or blended, whichever is faster
};
/// About a second on a software renderer, half of it to compile; best of five each. Throws SystemError where the
/// results show that the device did not do the work.
GlPeaks measure_gl_peaks();

/// The same of compute shaders, which more of a chip may run.
struct ComputePeaks {
    double operations_s = 0;  ///< per second: multiply-adds in registers, two each
    double bytes_s = 0;       ///< the device's memory: as much copied from a buffer texture into a storage buffer
};
/// As measure_gl_peaks().
ComputePeaks measure_compute_peaks();

}  // namespace radiafit

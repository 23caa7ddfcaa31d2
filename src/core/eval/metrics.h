#pragma once
#include <cmath>
#include <cstdint>

namespace radiafit {

/// Differences between a render and a photograph, pooled over pixels and channels. Both in [0, 1].
struct ErrorSums {
    double absolute = 0, squared = 0;
    uint64_t values = 0;
    uint64_t not_finite = 0;  ///< of these; they make every figure NaN, never vanish from it

    void add(double difference);
    void add(const ErrorSums& other);
    /// 255 mean |difference|: absolute pixel error on the scale of bytes. NaN without values.
    double ape() const;
    /// 10 log10(1 / mean squared difference), dB; infinite where there is no difference. NaN without values.
    double psnr() const;
};

/// Mean structural similarity of render and photograph (Wang, Bovik, Sheikh and Simoncelli 2004): of luma in the stored
/// encoding, under a Gaussian window of 11 x 11 pixels and a standard deviation of 1.5, over the windows that lie in
/// the foreground as a whole. 1: alike. Not a number where there is no such window.
struct SsimSum {
    double sum = 0;
    uint64_t windows = 0;
    double mean() const { return windows ? sum / double(windows) : NAN; }
    void add(const SsimSum& other) {
        sum += other.sum;
        windows += other.windows;
    }
};
}  // namespace radiafit

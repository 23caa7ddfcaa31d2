#pragma once
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

}  // namespace radiafit

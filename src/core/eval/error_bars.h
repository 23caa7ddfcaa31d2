#pragma once
#include <cstdint>

#include "base/linear.h"
#include "eval/metrics.h"

namespace radiafit {

/// What a contestant says of the accuracy of its colour at a pixel: standard deviations per channel, in its space.
struct ErrorBar {
    Vec3f fit = Vec3f::Zero();    ///< of the fitted colour, by the noise of the photographs that were fitted
    Vec3f noise = Vec3f::Zero();  ///< of a photograph's pixel about the true colour
    /// The fit is less certain here than one photograph would be: it does not follow from what was photographed
    /// (hidden extrapolation: Montgomery, Peck and Vining, Introduction to Linear Regression Analysis, section 3.8).
    bool doubtful() const { return !(fit.x() <= noise.x() && fit.y() <= noise.y() && fit.z() <= noise.z()); }
};

/// How error bars fare against photographs.
struct ErrorBarFigures {
    uint64_t values = 0, within = 0;  ///< channels of pixels; error at most one standard deviation of fit and noise
    ErrorSums sound, doubtful;        ///< errors in the stored encoding, by ErrorBar::doubtful()
    /// error: render less photograph in the contestant's space; stored: [3] in the stored encoding.
    void add(const ErrorBar& bar, const Vec3f& error, const float* stored);
    void add(const ErrorBarFigures& other);
    double within_share() const;    ///< 0.68 where error bars are true. NaN without values
    double doubtful_share() const;  ///< of the pixels. NaN without values
};

}  // namespace radiafit

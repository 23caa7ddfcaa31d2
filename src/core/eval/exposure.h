#pragma once
#include <vector>

#include "dataset/dataset.h"

namespace radiafit {

/// value in [0, 1], as a stored image holds it; a value that is not finite becomes NaN.
float clamped(float value);

/// What a camera of this exposure would have stored of linear light: clamped(encode(exposure * light)).
float exposed(Encoding encoding, double exposure, double light);

/// The exposure that brings `light` (linear, any sign) closest to `photograph` (stored, in [0, 1]; same length):
/// it minimizes sum (exposed(light) - photograph)^2 over 6 stops to either side of `around`, to 1e-5 stops. Returns
/// `around` where the sum is not finite, or all exposures are alike (black).
double find_exposure(Encoding encoding, const std::vector<float>& light, const std::vector<float>& photograph,
                     double around);

}  // namespace radiafit

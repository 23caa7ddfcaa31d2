#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "model/lfm.h"

namespace radiafit {

/// Start values: g = mean(L t) of the problem, h = 1; further terms g = 0, h = U(-0.3, 0.3) from `seed`.
/// mean [vertices][3]; result in LfmLayout's order. Zero for vertices without a ring sample (their mean is 0).
std::vector<float> lfm_start(const LfmLayout& layout, std::span<const float> mean, uint64_t seed);

/// Weight of E_r on the view map of a problem: lambda_view * (ring surface texels / m^2) * max(mean(L t)^2, 1e-3),
/// which puts it on a par with the surface maps' whatever the ring's size and brightness.
float scaled_lambda_view(const LfmOptions& options, size_t ring_texels, float mean);

/// 1 / S-bar: a problem's surface texels over its samples, which are not 0. E and its derivatives are multiplied by it.
double inverse_density(const LfmOptions& options, size_t ring_texels, uint32_t samples);

}  // namespace radiafit

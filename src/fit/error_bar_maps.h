#pragma once
#include "fit/texel_fit.h"

namespace radiafit {

/// Of a light field map: bars' numbers in the order of its parameters and problems. deviation_NAME.exr for each map,
/// and error_bars.exr, a pixel per vertex: noise and deficient, each .R, .G, .B.
void write_error_bars(const std::filesystem::path& folder, const LightFieldFit& fit, const Mesh& mesh,
                      const ErrorBarMaps& bars);

}  // namespace radiafit

#pragma once
#include "fit/texel_fit.h"

namespace radiafit {

inline constexpr const char* error_bars_name = "error_bars.exr";

/// For a light field map; bars' numbers are in the order of its parameters and problems. deviation_NAME.exr for each
/// map, and error_bars.exr, a pixel per vertex: noise and deficient, each .R, .G, .B.
void write_error_bars(const std::filesystem::path& folder, const LightFieldFit& fit, const Mesh& mesh,
                      const ErrorBarMaps& bars);

/// Whether a fit's folder has such maps, of any model.
bool has_error_bars(const std::filesystem::path& folder);

}  // namespace radiafit

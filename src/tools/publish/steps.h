#pragma once
#include <array>
#include <vector>

#include "publish/page_model.h"

namespace radiafit::tools {

/// By how much the picture changes, in the root mean square of sRGB values (white is 1), when a channel of a stored map
/// does by
/// 1. [maps]; measured by rendering three training views with noise on a map after another.
std::vector<std::array<float, 3>> map_effects(PageModel& model, const Dataset& dataset,
                                              const std::vector<uint32_t>& training);

/// Steps of every map's channels such that all together move the picture by so much (root mean square), each by as much
/// as any other: uniform noise of step / sqrt 12.
std::vector<std::array<float, 3>> map_steps(const PageModel& model, const std::vector<std::array<float, 3>>& effects,
                                            double rms);

}  // namespace radiafit::tools

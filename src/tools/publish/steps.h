#pragma once
#include <array>
#include <functional>
#include <vector>

#include "publish/page_model.h"

namespace radiafit::tools {

/// By how much the picture changes, in the root mean square of sRGB values (white is 1), when a channel of a stored map
/// does by
/// 1. [maps]; measured on three training views with noise on a map after another, each of chosen_steps(); `measured`:
/// after each of these.
std::vector<std::array<float, 3>> map_effects(PageModel& model, const Dataset& dataset,
                                              const std::vector<uint32_t>& training,
                                              const std::function<void()>& measured);

/// How many steps map_steps() chooses: of a map whose channels have one unit there is one.
size_t chosen_steps(const PageModel& model);

/// Steps of every map's channels such that all together move the picture by so much (root mean square), each by as much
/// as any other: uniform noise of step / sqrt 12.
std::vector<std::array<float, 3>> map_steps(const PageModel& model, const std::vector<std::array<float, 3>>& effects,
                                            double rms);

}  // namespace radiafit::tools

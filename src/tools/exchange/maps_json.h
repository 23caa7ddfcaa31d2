#pragma once
#include <optional>
#include <string>

#include "exchange/relief.h"
#include "exchange/surface_look.h"
#include "exchange/surface_normals.h"

namespace radiafit::tools {

/// maps.json of exported maps: what their values mean (docs/formats.md, "MAPS folder"). normals, relief: where there
/// are any. grid: whether the maps are a grid's.
std::string maps_json(const SurfaceLook& look, const std::optional<SurfaceNormals>& normals,
                      const std::optional<Relief>& relief, bool grid);

}  // namespace radiafit::tools

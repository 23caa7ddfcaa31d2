#pragma once
#include <string>
#include <vector>

#include "publish/coded_map.h"
#include "publish/publish.h"

/// Parts of a page's JSON (docs/viewer.md), as text; the bytes that they name are added to `page`.
namespace radiafit::tools {

std::string shaders_json(const Published& fit);
/// Sets of textures, and the maps in them.
std::string maps_json(const PageModel& model, const std::vector<CodedMap>& coded, Page& page);
/// The surface, tables, and numbers of the shader.
std::string surface_json(const Published& fit, Page& page);
std::string model_json(const Published& fit, Page& page);
/// Directions of the views that were fitted, and from where on a view counts as far from them.
std::string directions_json(const Published& fit);
/// A view with its photograph and the baseline's picture of it.
std::string view_json(const Published& fit, uint32_t view, const JudgedView& judged, const JudgedView& baseline,
                      Page& page);
/// The fit's picture of a view as a small WebP: what a page shows until it can draw.
std::string picture_of(const JudgedView& judged, Encoding encoding);

}  // namespace radiafit::tools

#include "exchange/maps_json.h"

#include <nlohmann/json.hpp>

#include "base/json.h"

namespace radiafit::tools {

std::string maps_json(const SurfaceLook& look, const std::optional<SurfaceNormals>& normals,
                      const std::optional<Relief>& relief, bool grid) {
    using Json = nlohmann::ordered_json;
    Json out = {{"base_colour", {{"meaning", look.meaning}, {"is_albedo", look.albedo}}}};
    if (normals)
        out["normals"] = {{"from", normals->lamps > 0 ? "fit" : "dataset"},
                          {"lamps", normals->lamps},
                          {"axes", grid ? "right, up, out of the plane" : "the mesh's"}};
    if (relief)
        out["height"] = {{"unit", relief->in_pixels() ? "pixel" : "world unit"},
                         {"least", double(relief->least)},
                         {"most", double(relief->most)},
                         {"texel", relief->step},
                         {"png", {{"none", 0}, {"least", 1}, {"most", 65535}}},
                         {"pieces", relief->parts}};
    return json_text(out, 2) + "\n";
}

}  // namespace radiafit::tools

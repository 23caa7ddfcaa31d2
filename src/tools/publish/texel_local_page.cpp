// Texel-local models; shaders/view/texel_local.frag.
#include <fmt/format.h>

#include "eval/safe_relighting.h"
#include "fit/fit_maps.h"
#include "publish/pages.h"

namespace radiafit::tools {
namespace {

/// What a page shows: a fit with the numbers of decoded maps.
struct Shown {
    ReflectanceFit fit;
    std::unique_ptr<Atlas> atlas;
};

}  // namespace

PageModel page_model_of(const ReflectanceFit& fit, const Atlas& atlas, const Dataset& dataset,
                        const std::vector<uint32_t>& training) {
    const TexelModel& model = *fit.options.model;
    const std::vector<TexelMap> maps = maps_of(model);
    PageModel page{.shader = "texel_local"};
    page.maps = parameter_maps(maps, fit.parameters, atlas);
    const size_t parameters = page.maps.size();
    const SafeRelighting safe(dataset, training, atlas, fit);
    for (PageMap& map : bound_maps(safe.bounds(), atlas)) page.maps.push_back(std::move(map));
    page.maps.push_back(knowledge_map(fit, atlas));
    page.defines = {{"MODEL", model.name}, {"CURVE", std::to_string(int(fit.options.curve))}};
    const size_t normals = page.maps.size();
    const bool own_normals = has_normal_map(dataset);
    if (own_normals) {
        page.maps.push_back(normal_map(atlas));
        page.defines.emplace_back("NORMAL_MAP", std::to_string(normals));
    }
    for (const std::string& name : model.coefficient_names) page.terms.push_back(name);
    page.uniforms.push_back({"most", {SafeRelighting::most}});
    page.residual_unit = "reflectance, white = 1";
    if (fit.options.curve != ValueCurve::linear)
        page.residual_unit += fmt::format(", on the curve {}", name_of(fit.options.curve));
    if (!dataset.has_grid()) page.largest_side = fit.options.surface_side;
    page.atlas = &atlas;

    page.shown = [&fit, &atlas, &dataset, training, maps, parameters, normals,
                  own_normals](const std::vector<PageMap>& decoded) {
        const auto shown = std::make_shared<Shown>();
        shown->fit = fit;
        shown->fit.parameters = parameters_of(maps, decoded, atlas);
        if (own_normals) shown->atlas = atlas_with(decoded[normals], atlas, dataset, fit.options.surface_side);
        const Atlas& texels = own_normals ? *shown->atlas : atlas;
        return ShownMaps{kept_alive(contestant_of(std::make_shared<const SafeRelighting>(
                                        dataset, training, texels, shown->fit, bounds_of(&decoded[parameters], atlas))),
                                    shown)};
    };
    return page;
}

}  // namespace radiafit::tools

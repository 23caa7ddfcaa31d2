// Texel-local models; shaders/view/texel_local.frag.
#include <fmt/format.h>

#include "eval/safe_relighting.h"
#include "fit/fit_maps.h"
#include "publish/pages.h"

namespace radiafit::tools {
namespace {

constexpr float root_step = 1.0f / 255;

/// What a page shows: a fit with the numbers of decoded maps.
struct Shown {
    ReflectanceFit fit;
    std::unique_ptr<Atlas> atlas;
};

std::vector<TexelMap> bound_maps() { return {{"albedo", map_channels(), 0}, {"brightest", map_channels(), 3}}; }

std::vector<float> floats_of(const std::vector<SafeRelighting::Bounds>& bounds) {
    std::vector<float> all;
    for (const auto& b : bounds) {
        all.insert(all.end(), b.albedo.begin(), b.albedo.end());
        all.insert(all.end(), b.brightest.begin(), b.brightest.end());
    }
    return all;
}

}  // namespace

PageModel page_model_of(const ReflectanceFit& fit, const Atlas& atlas, const Dataset& dataset,
                        const std::vector<uint32_t>& training) {
    const TexelModel& model = *fit.options.model;
    const std::vector<TexelMap> maps = maps_of(model);
    PageModel page{.shader = "texel_local"};
    page.maps = parameter_maps(maps, fit.parameters, atlas);
    const size_t parameters = page.maps.size();
    const SafeRelighting safe(dataset, training, atlas, fit);
    for (PageMap& map : parameter_maps(bound_maps(), floats_of(safe.bounds()), atlas)) {
        map.root = true;
        map.fixed_step = {root_step, root_step, root_step};
        page.maps.push_back(std::move(map));
    }
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
        const std::vector<float> flat = parameters_of(bound_maps(), {&decoded[parameters], 2}, atlas);
        std::vector<SafeRelighting::Bounds> bounds(atlas.texel_count());
        for (size_t t = 0; t < bounds.size(); ++t) bounds[t] = {Vec3f::Map(&flat[6 * t]), Vec3f::Map(&flat[6 * t + 3])};
        const Atlas& texels = own_normals ? *shown->atlas : atlas;
        return kept_alive(contestant_of(std::make_shared<const SafeRelighting>(dataset, training, texels, shown->fit,
                                                                               std::move(bounds))),
                          shown);
    };
    return page;
}

}  // namespace radiafit::tools

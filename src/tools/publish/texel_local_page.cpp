// Texel-local models; shaders/view/texel_local.frag.
#include <fmt/format.h>

#include "eval/safe_relighting.h"
#include "fit/fit_maps.h"
#include "publish/pages.h"

namespace radiafit::tools {
namespace {

constexpr float root_step = 1.0f / 255;
constexpr float finest_normals = 1.0f / 512;  // at least so fine, since lamps move to where no image shows the error

/// What a page shows: a fit with the numbers of decoded maps.
struct Shown {
    ReflectanceFit fit;
    std::unique_ptr<Atlas> atlas;
};

std::vector<Vec3f> normals_in(const Atlas& atlas) {
    std::vector<Vec3f> normals;
    for (uint32_t t = 0; t < atlas.texel_count(); ++t)
        normals.push_back(atlas.usable(t) ? atlas.normal(t) : Vec3f::Zero());
    return normals;
}

std::vector<TexelMap> bound_maps() { return {{"albedo", map_channels(), 0}, {"brightest", map_channels(), 3}}; }
std::vector<TexelMap> normal_maps() { return {{"normal", {"x", "y", "z"}, 0}}; }

std::vector<float> floats_of(const std::vector<SafeRelighting::Bounds>& bounds) {
    std::vector<float> all;
    for (const auto& b : bounds) {
        all.insert(all.end(), b.albedo.begin(), b.albedo.end());
        all.insert(all.end(), b.brightest.begin(), b.brightest.end());
    }
    return all;
}

/// A map of normals, where they are finer than a mesh's or a plane's.
bool has_normal_map(const Dataset& dataset) {
    return dataset.has_grid() ? !dataset.grid.texel_normals.empty() : dataset.normal_map.side > 0;
}

std::unique_ptr<Atlas> atlas_with(const std::vector<float>& normals, const ReflectanceFit& fit,
                                  const Dataset& dataset) {
    std::vector<Vec3f> unit;
    for (size_t i = 0; i < normals.size(); i += 3) {
        const Vec3f normal(normals[i], normals[i + 1], normals[i + 2]);
        unit.push_back(normal.norm() > 0.001f ? Vec3f(normal.normalized()) : Vec3f::Zero());
    }
    if (!dataset.has_grid()) {
        auto atlas = std::make_unique<TriangleAtlas>(dataset.mesh, fit.options.surface_side);
        atlas->set_normals(std::move(unit));
        return atlas;
    }
    Grid grid = dataset.grid;
    grid.texel_normals = std::move(unit);
    return std::make_unique<GridAtlas>(make_atlas(grid));
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
    page.defines = {{"MODEL", model.name}};
    const size_t normals = page.maps.size();
    const bool own_normals = has_normal_map(dataset);
    if (own_normals) {
        std::vector<float> values;
        for (const Vec3f& n : normals_in(atlas)) values.insert(values.end(), n.begin(), n.end());
        page.maps.push_back(parameter_maps(normal_maps(), values, atlas)[0]);
        page.maps.back().one_unit = true;
        page.maps.back().most_step = finest_normals;
        page.defines.emplace_back("NORMAL_MAP", std::to_string(normals));
    }
    for (const std::string& name : model.coefficient_names) page.terms.push_back(name);
    page.uniforms.push_back({"most", {SafeRelighting::most}});
    page.residual_unit = "reflectance, white = 1";
    if (!dataset.has_grid()) page.largest_side = fit.options.surface_side;
    page.atlas = &atlas;

    page.shown = [&fit, &atlas, &dataset, training, maps, parameters, normals,
                  own_normals](const std::vector<PageMap>& decoded) {
        const auto shown = std::make_shared<Shown>();
        shown->fit = fit;
        shown->fit.parameters = parameters_of(maps, decoded, atlas);
        if (own_normals)
            shown->atlas = atlas_with(parameters_of(normal_maps(), {&decoded[normals], 1}, atlas), fit, dataset);
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

// Light bases; shaders/view/light_basis.frag.
#include <fmt/format.h>

#include "publish/pages.h"

namespace radiafit::tools {
namespace {

/// For every block and reference lamp: the mean, then the functions, the three channels of each in an entry.
PageTable table_of(const LightBasis& basis) {
    const LampFunctions functions(basis, double(basis.smoothing));
    const auto lamps = Eigen::Index(basis.lamps.size());
    PageTable table{"basis_table", {}};
    for (size_t block = 0; block < basis.cubes.size(); ++block)
        for (Eigen::Index i = 0; i < lamps; ++i)
            for (int k = 0; k <= basis.rank; ++k) {
                for (int c = 0; c < 3; ++c) table.entries.push_back(functions.block(block)(c * lamps + i, k));
                table.entries.push_back(0);
            }
    return table;
}

/// The reference lamps, each with its half vector behind it where there is one.
PageTable lamps_of(const LightBasis& basis) {
    PageTable table{"lamp_table", {}};
    const auto add = [&](const Vec3f& v) { table.entries.insert(table.entries.end(), {v.x(), v.y(), v.z(), 0}); };
    for (const LampAndHalf& at : basis.lamps) {
        add(at.lamp);
        if (basis.by_half()) add(at.half);
    }
    return table;
}

/// A fit with the numbers of decoded maps.
struct ShownLightBasis {
    LightBasisFit fit;
    std::unique_ptr<Atlas> atlas;  ///< with decoded normals; null: the fit's
};

std::vector<float> numbers(const Vec3f& v) { return {v.x(), v.y(), v.z()}; }

}  // namespace

PageModel page_model_of(const LightBasisFit& fit, const Atlas& atlas, const Dataset& dataset,
                        const std::vector<uint32_t>& training) {
    const std::vector<TexelMap> maps = maps_of(fit);
    const LightBasis& basis = fit.basis;
    PageModel page{.shader = fit.underneath ? "light_basis_upon" : "light_basis"};
    page.maps = parameter_maps(maps, fit.parameters, atlas);
    const size_t parameters = page.maps.size();
    if (fit.underneath) {
        const ReflectanceFit underneath = underneath_of(fit);
        const SafeRelighting safe(dataset, training, atlas, underneath);
        for (PageMap& map : bound_maps(safe.bounds(), atlas)) page.maps.push_back(std::move(map));
    }
    page.maps.push_back(block_map(basis, atlas));
    page.maps.push_back(knowledge_map(fit, atlas));
    page.tables = {table_of(basis), lamps_of(basis)};
    page.defines = {{"RANK", std::to_string(basis.rank)},
                    {"LAMPS", std::to_string(basis.lamps.size())},
                    {"CURVE", std::to_string(int(basis.curve))}};
    page.terms.push_back("mean");
    for (int k = 1; k <= basis.rank; ++k) page.terms.push_back(fmt::format("function {}", k));
    page.uniforms = {{"up", numbers(basis.up)},
                     {"white", numbers(basis.white)},
                     {"length_between", {basis.length}},
                     {"least_cosine", {least_cosine}},
                     {"most_bright", {most_bright}}};
    if (basis.by_half()) {
        page.defines.emplace_back("HALF", "1");
        page.uniforms.push_back({"half_length", {basis.half_length}});
        page.uniforms.push_back({"half_share", {basis.half_share}});
    }
    if (fit.underneath) {
        page.defines.emplace_back("MODEL", fit.underneath->name);
        for (const std::string& name : fit.underneath->coefficient_names) page.terms.push_back(name);
        page.uniforms.push_back({"most", {SafeRelighting::most}});
    }
    if (basis.frame) {
        page.uniforms.emplace_back("frame_x", numbers(basis.frame->tangent));
        page.uniforms.emplace_back("frame_y", numbers(basis.frame->bitangent));
        page.uniforms.emplace_back("frame_z", numbers(basis.frame->normal));
    }
    page.fades = fit.underneath != nullptr;
    page.residual_unit = fmt::format("on the curve {}, white = 1", name_of(basis.curve));
    if (!dataset.has_grid()) page.largest_side = fit.surface_side;
    page.atlas = &atlas;
    const size_t normals = page.maps.size();
    const bool own_normals = has_normal_map(dataset);
    if (own_normals) {
        page.maps.push_back(normal_map(atlas));
        page.defines.emplace_back("NORMAL_MAP", std::to_string(normals));
    }
    page.shown = [&fit, &atlas, &dataset, training, maps, parameters, normals,
                  own_normals](const std::vector<PageMap>& decoded) {
        const auto shown = std::make_shared<ShownLightBasis>();
        shown->fit = fit;
        shown->fit.parameters = parameters_of(maps, decoded, atlas);
        if (own_normals) shown->atlas = atlas_with(decoded[normals], atlas, dataset, fit.surface_side);
        std::vector<SafeRelighting::Bounds> bounds;
        if (fit.underneath) bounds = bounds_of(&decoded[parameters], atlas);
        return ShownMaps{kept_alive(
            contestant_of(shown->fit, own_normals ? *shown->atlas : atlas, dataset, training, std::move(bounds)),
            shown)};
    };
    return page;
}

}  // namespace radiafit::tools

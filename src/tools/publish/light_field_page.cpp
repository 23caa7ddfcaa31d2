// Light field maps; shaders/view/lfm.frag and lfm_vertices.frag.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "fit/fit_maps.h"
#include "publish/pages.h"

namespace radiafit::tools {
namespace {

struct Layout {
    TriangleAtlas atlas;
    LfmLayout maps;
    Layout(const Mesh& mesh, const LfmOptions& o)
        : atlas(surface_atlas(mesh, o)), maps(VertexRings(mesh), atlas, o.view_side, o.terms) {}
};

/// A fit whose problems without samples show nothing, as the renderer has it: there the view maps are 0.
LightFieldFit without_unseen(const LightFieldFit& fit, const LfmLayout& layout) {
    LightFieldFit out = fit;
    for (size_t q = 0; q < fit.samples.size(); ++q) {
        if (fit.samples[q] > 0 && fit.status[q] != Status::no_samples) continue;
        for (size_t at = layout.view_offset(q / 3) + q % 3; at < layout.offset(q / 3) + layout.block_size(q / 3);
             at += 4)
            out.parameters[at] = 0;
    }
    return out;
}

/// For each vertex, the samples of the channel with the fewest, and the residual over all three.
PageTable knowledge_of(const LightFieldFit& fit) {
    PageTable table{"vertex_knowledge", {}};
    for (size_t q = 0; q < fit.samples.size(); q += 3) {
        const uint32_t samples = std::min({fit.samples[q], fit.samples[q + 1], fit.samples[q + 2]});
        const float error = fit.error[q] + fit.error[q + 1] + fit.error[q + 2];
        table.entries.insert(table.entries.end(),
                             {std::log2(1 + float(samples)), root_mean_square(error, samples), 0, 0});
    }
    return table;
}

/// Which map of the shader's order this is: all surface maps, a term's corners one after another, then the view maps.
struct Place {
    bool surface;
    int term, corner;
};
Place place_of(size_t map, int terms) {
    const int number = int(map), views = number - 3 * terms;
    return views < 0 ? Place{true, number / 3, number % 3} : Place{false, views, 0};
}

}  // namespace

PageModel page_model_of(const LightFieldFit& fit, const Mesh& mesh) {
    const auto layout = std::make_shared<const Layout>(mesh, fit.options);
    const int terms = fit.options.terms;
    const LightFieldFit seen = without_unseen(fit, layout->maps);
    PageModel page{.shader = "lfm", .vertex_shader = "lfm_vertices", .vertex_entries = terms + 1};
    page.maps.resize(size_t(4 * terms));
    for (size_t map = 0; map < page.maps.size(); ++map) {
        const auto [surface, k, c] = place_of(map, terms);
        page.maps[map].name = surface ? fmt::format("surface{}{}", k, c) : fmt::format("view{}", k);
        page.maps[map].place = surface ? MapPlace::surface : MapPlace::view;
        page.maps[map].image = surface ? surface_image(layout->atlas, layout->maps, seen.parameters, k, c)
                                       : view_image(layout->maps, seen.parameters, k);
    }
    page.tables.push_back(knowledge_of(fit));
    page.defines = {{"TERMS", std::to_string(terms)}};
    if (fit.options.lookup == ViewLookup::nearest) page.defines.emplace_back("NEAREST", "1");
    page.whole_uniforms = {{"view_side", fit.options.view_side}, {"view_columns", table_columns(mesh.vertex_count())}};
    for (int k = 1; k <= terms; ++k) page.terms.push_back(fmt::format("term {}", k));
    page.residual_unit = "pixel values, white = 1";
    page.largest_side = fit.options.surface_side;
    page.atlas = &layout->atlas;
    if (fit.options.sides) page.sides = *fit.options.sides;
    page.shown = [&fit, &mesh, layout, terms](const std::vector<PageMap>& decoded) {
        const auto shown = std::make_shared<LightFieldFit>(fit);
        const auto change = [shown, layout, terms](size_t map, const PageMap& other) {
            const auto [surface, k, c] = place_of(map, terms);
            if (surface)
                take_surface_image(other.image, layout->atlas, layout->maps, k, c, *shown);
            else
                take_view_image(other.image, layout->maps, k, *shown);
        };
        for (size_t map = 0; map < size_t(4 * terms); ++map) change(map, decoded[map]);
        return ShownMaps{kept_alive(contestant_of(*shown, mesh), shown), change};
    };
    return page;
}

}  // namespace radiafit::tools

// View bases; shaders/view/view_basis.frag.
#include <fmt/format.h>

#include "publish/pages.h"

namespace radiafit::tools {
namespace {

/// For every block and polynomial: the means of the three channels, then the functions, in whole entries of four.
PageTable table_of(const ViewBasis& basis) {
    PageTable table{"basis_table", {}};
    const size_t columns = size_t(3 + basis.rank), entries = (columns + 3) / 4;
    for (size_t row = 0; row < basis.numbers.size(); row += columns) {
        const auto first = basis.numbers.begin() + ptrdiff_t(row);
        table.entries.insert(table.entries.end(), first, first + ptrdiff_t(columns));
        table.entries.resize(table.entries.size() + 4 * entries - columns, 0);
    }
    return table;
}

}  // namespace

PageModel page_model_of(const ViewBasisFit& fit, const TriangleAtlas& atlas) {
    const std::vector<TexelMap> maps = maps_of(fit.basis);
    PageModel page{.shader = "view_basis", .vertex_shader = "vertex_angles", .vertex_entries = 1};
    page.maps = parameter_maps(maps, fit.parameters, atlas);
    page.maps.push_back(block_map(fit.basis, atlas));
    page.maps.push_back(knowledge_map(fit, atlas));
    page.tables.push_back(table_of(fit.basis));
    page.defines = {{"RANK", std::to_string(fit.basis.rank)}};
    page.terms.push_back("mean");
    for (int k = 1; k <= fit.basis.rank; ++k) page.terms.push_back(fmt::format("function {}", k));
    page.uniforms.push_back({"up", {fit.basis.up.begin(), fit.basis.up.end()}});
    page.residual_unit = "pixel values, white = 1";
    page.largest_side = fit.surface_side;
    page.atlas = &atlas;
    page.shown = shown_by_view(fit, atlas, maps);
    return page;
}

}  // namespace radiafit::tools

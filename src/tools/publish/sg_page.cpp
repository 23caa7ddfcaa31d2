// Spherical Gaussians; shaders/view/sg.frag.
#include <fmt/format.h>

#include "publish/pages.h"

namespace radiafit::tools {

PageModel page_model_of(const SgFit& fit, const TriangleAtlas& atlas) {
    const std::vector<TexelMap> maps = sg_maps(fit.lobes);
    PageModel page{.shader = "sg", .vertex_shader = "vertex_angles", .vertex_entries = 1};
    page.maps = parameter_maps(maps, fit.parameters, atlas);
    page.maps.push_back(knowledge_map(fit, atlas));
    page.defines = {{"LOBE_COUNT", std::to_string(fit.lobes)}};
    page.terms.push_back("diffuse");
    for (int l = 1; l <= fit.lobes; ++l) page.terms.push_back(fmt::format("lobe {}", l));
    page.uniforms.push_back({"up", {fit.up.begin(), fit.up.end()}});
    page.residual_unit = "pixel values, white = 1";
    page.largest_side = fit.surface_side;
    page.atlas = &atlas;
    page.shown = shown_by_view(fit, atlas, maps);
    return page;
}

}  // namespace radiafit::tools

#include <fmt/format.h>

#include "app/choices.h"
#include "geometry/atlas.h"
#include "geometry/vertex_rings.h"
#include "gl/fragment_plan.h"

namespace radiafit {

uint64_t total_bytes(const std::vector<PlanRow>& rows) {
    uint64_t sum = 0;
    for (const PlanRow& row : rows) sum += row.bytes;
    return sum;
}

std::vector<PlanRow> plan(const Dataset& dataset, const FitRequest& request) {
    require_light_field(dataset);
    const LfmOptions options = request.model_options();
    const VertexRings rings(dataset.mesh);
    std::vector<PlanRow> rows;
    if (request.engine == "fragment") {
        const TriangleAtlas atlas(dataset.mesh, options.surface_side);
        for (PlannedArray& a :
             plan_fragment_engine(dataset, atlas, rings, dataset.split(false), options, fragment_options(request)))
            rows.push_back({std::move(a.array), std::move(a.shape), a.count, a.bytes});
        return rows;
    }
    const int tile_texels = options.surface_side * (options.surface_side + 1) / 2;
    const LfmLayout layout(rings, tile_texels, options.view_side, options.terms);
    const size_t training = dataset.split(false).size();
    const uint64_t vector_bytes = layout.size() * sizeof(float);
    const auto add = [&](std::string name, std::string shape, uint64_t count, uint64_t bytes) {
        rows.push_back({std::move(name), std::move(shape), count, bytes});
    };
    for (const char* name : {"p", "trial", "d", "g", "trial g", "P", "fresh P"})
        add(name, fmt::format("{} texels x 4 floats", layout.size() / 4), layout.parameter_count(), vector_bytes);
    add("view footprints", fmt::format("{} vertices x {} images", rings.vertex_count(), training),
        rings.vertex_count() * training, rings.vertex_count() * training * 20);
    uint64_t pixels = 0;
    for (uint32_t view : dataset.split(false))
        pixels += uint64_t(dataset.views[view].camera.width) * dataset.views[view].camera.height;
    add("samples, at most", "pixels x 8 bytes", pixels, 8 * pixels);
    return rows;
}

std::vector<PlanRow> paper_layout(size_t triangles, size_t vertices, int surface_side, int view_side) {
    const uint64_t tile = uint64_t(surface_side) * surface_side, view = uint64_t(view_side) * view_side;
    const uint64_t maps = 6 * 3 * triangles * tile, sls = 2 * triangles * tile, views = 6 * vertices * view;
    return {{"surface maps", fmt::format("{} x 3 maps x {} texels x 6 arrays", triangles, tile), maps, 16 * maps},
            {"SLS", fmt::format("{} x {} texels x 2 arrays", triangles, tile), sls, 16 * sls},
            {"view maps", fmt::format("{} x {} texels x 6 arrays", vertices, view), views, 16 * views}};
}

}  // namespace radiafit

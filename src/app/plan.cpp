#include <fmt/format.h>

#include "app/choices.h"
#include "app/solver.h"
#include "base/parallel.h"
#include "cpu/texel_solver.h"
#include "geometry/atlas.h"
#include "geometry/vertex_rings.h"
#include "gl/fragment_plan.h"
#include "gl/texel_plan.h"

namespace radiafit {

uint64_t total_bytes(const std::vector<PlanRow>& rows) {
    uint64_t sum = 0;
    for (const PlanRow& row : rows) sum += row.bytes;
    return sum;
}

namespace {

std::vector<PlanRow> rows_of(const std::vector<PlannedArray>& arrays) {
    std::vector<PlanRow> rows;
    for (const PlannedArray& a : arrays) rows.push_back({a.array, a.shape, a.count, a.bytes});
    return rows;
}

/// Pixels in texels over all training views, from every eighth of them.
uint64_t estimate_samples(const Dataset& dataset, const Atlas& atlas, const FitRequest& request) {
    const std::vector<uint32_t> views = fitted_views(dataset, request);
    FitRequest on_cpu = request;
    on_cpu.distributor = "cpu";
    const Distributors distributors = make_distributors(atlas, on_cpu);
    const size_t step = 8, looked_at = (views.size() + step - 1) / step;
    std::vector<uint64_t> kept(looked_at, 0);
    std::vector<std::unique_ptr<ImageStream>> streams{size_t(thread_count())};
    parallel_for(looked_at, 1, [&](size_t i, int worker) {
        auto& stream = streams[size_t(worker)];
        if (!stream) stream = std::make_unique<ImageStream>(dataset, StreamSource::disk, TargetSpace::linear);
        TargetImage image;
        Distribution distribution;
        const uint32_t view = views[i * step];
        stream->load_mask(view, image);
        distributors.owned[size_t(worker)]->distribute(dataset.views[view].camera, image, distribution);
        kept[i] = distribution.kept_pixels;
    });
    uint64_t sum = 0;
    for (const uint64_t k : kept) sum += k;
    return looked_at ? sum * views.size() / looked_at : 0;
}

std::vector<PlanRow> plan_texels(const Dataset& dataset, const FitRequest& request) {
    require_lights(dataset);
    const TexelOptions options = request.texel_options();
    const auto atlas = texel_atlas(dataset, options.surface_side);
    if (request.solver == "stream" && request.engine == "fragment")
        return rows_of(
            plan_texel_engine(dataset, *atlas, fitted_views(dataset, request), options, fragment_options(request)));
    const uint64_t texels = atlas->texel_count(), samples = estimate_samples(dataset, *atlas, request);
    const uint64_t n = uint64_t(options.model->parameters);
    std::vector<PlanRow> rows;
    rows.push_back({"results", fmt::format("{} texels x ({} parameters, 4 figures)", texels, n), texels * n,
                    texels * 4 * (n + 4) - 3 * texels});
    if (request.solver == "two-step") {
        rows.push_back(
            {"samples held in step 1, at most", "--memory, beside an image per thread", 0, request.memory_bytes()});
        return rows;
    }
    rows.push_back({"samples, about", fmt::format("pixels in texels x {} bytes", sizeof(TexelRadiance)), samples,
                    samples * sizeof(TexelRadiance)});
    if (request.solver == "stream" && !request.levenberg_marquardt())
        rows.push_back({"engine, about",
                        "shaded samples in batches of eight texels; p, trial, d, g, trial g, P, fresh P", samples,
                        texel_solvers(*options.model).stream_bytes(texels, samples)});
    return rows;
}

}  // namespace

std::vector<PlanRow> plan(const Dataset& dataset, const FitRequest& request) {
    if (request.texel_local()) return plan_texels(dataset, request);
    require_light_field(dataset);
    const LfmOptions options = request.model_options();
    const VertexRings rings(dataset.mesh);
    if (request.engine == "fragment") {
        const TriangleAtlas atlas(dataset.mesh, options.surface_side);
        return rows_of(plan_fragment_engine(dataset, atlas, rings, fitted_views(dataset, request), options,
                                            fragment_options(request)));
    }
    std::vector<PlanRow> rows;
    const int tile_texels = options.surface_side * (options.surface_side + 1) / 2;
    const LfmLayout layout(rings, tile_texels, options.view_side, options.terms);
    const size_t training = fitted_views(dataset, request).size();
    const uint64_t vector_bytes = layout.size() * sizeof(float);
    const auto add = [&](std::string name, std::string shape, uint64_t count, uint64_t bytes) {
        rows.push_back({std::move(name), std::move(shape), count, bytes});
    };
    for (const char* name : {"p", "trial", "d", "g", "trial g", "P", "fresh P"})
        add(name, fmt::format("{} texels x 4 floats", layout.size() / 4), layout.parameter_count(), vector_bytes);
    add("view footprints", fmt::format("{} vertices x {} images", rings.vertex_count(), training),
        rings.vertex_count() * training, rings.vertex_count() * training * 20);
    uint64_t pixels = 0;
    for (uint32_t view : fitted_views(dataset, request))
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

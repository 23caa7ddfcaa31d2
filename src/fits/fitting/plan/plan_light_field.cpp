#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "base/parallel.h"
#include "compute/compute_plan.h"
#include "cpu/lfm_kernels.h"
#include "fit/fit_maps.h"
#include "fitting/family.h"
#include "fitting/fit_options.h"
#include "fitting/plan/plan_rows.h"
#include "fitting/solvers/solver.h"
#include "fragment/fragment_plan.h"
#include "geometry/vertex_rings.h"
#include "reference/solver_memory.h"

namespace radiafit::fits {
namespace {

/// Pixels of all fitted views.
uint64_t pixels_of(const Dataset& dataset, const std::vector<uint32_t>& views) {
    uint64_t pixels = 0;
    for (const uint32_t view : views)
        pixels += uint64_t(dataset.views[view].camera.width) * uint64_t(dataset.views[view].camera.height);
    return pixels;
}

/// What list_samples() finds. tiles: [tiles].
SampleEstimate estimate_list(const Dataset& dataset, const TriangleAtlas& atlas, const FitRequest& request,
                             size_t most_views, std::vector<uint64_t>* tiles = nullptr) {
    return request.surface == SurfaceLookup::linear ? estimate_interpolated(dataset, atlas, request, most_views, tiles)
                                                    : estimate_samples(dataset, atlas, request, most_views, tiles);
}

/// Whether all samples' colours are of 8 bits, as stored.
bool of_8_bits(const Dataset& dataset, const FitRequest& request) {
    return request.surface == SurfaceLookup::nearest &&
           ImageStream(dataset, StreamSource::disk, request.space).bits() == 8;
}

/// Bytes of a sample in the records of two-step: it is in three vertices' blocks, and once more in a file in which it
/// waits to be sorted.
uint64_t record_bytes(const FitRequest& request) {
    constexpr uint64_t longest_compact = 10, full = 56, waiting = 16;
    return 3 * (request.record == RecordKind::full ? full : longest_compact) + waiting;
}

/// What the threads of a solver of one vertex after another hold, each at the largest vertex.
void add_vertex_work(const Dataset& dataset, const TriangleAtlas& atlas, const VertexRings& rings,
                     const FitRequest& request, size_t most_views, std::vector<PlanRow>& rows) {
    const Solver& solver = find_solver(request.solver);
    if (!solver.vertex_bytes) return;
    std::vector<uint64_t> tiles(dataset.mesh.triangle_count());
    if (facts_of(request).ceres) estimate_list(dataset, atlas, request, most_views, &tiles);
    const LfmLayout layout(rings, atlas, 1, 1);
    VertexShape largest;
    for (size_t v = 0; v < rings.vertex_count(); ++v) {
        size_t samples = 0;
        for (const Corner& corner : rings.ring(v)) samples += tiles[corner.triangle];
        // Of maps of several sides, as many of the largest as have the vertex's texels.
        const size_t maps = (layout.surface_texels(v) + atlas.texels_per_tile() - 1) / atlas.texels_per_tile();
        largest = {std::max(largest.maps, maps), std::max(largest.samples, samples)};
    }
    const uint64_t bytes = solver.vertex_bytes(request, largest);
    const auto threads = std::min(uint64_t(thread_count()), uint64_t(rings.vertex_count()));
    rows.push_back({"largest vertex, per thread",
                    fmt::format("{} surface maps, {} threads x {} bytes", largest.maps, threads, bytes), threads,
                    threads * bytes, PlanRow::while_solving});
}

/// What a fit on the processor holds beside its parameters: the list of samples, which are brought into their tiles'
/// order once, tables of the mesh, and a map on its way to disk.
void add_lists(const Dataset& dataset, const TriangleAtlas& atlas, const LfmLayout& layout, const SampleEstimate& seen,
               const FitRequest& request, std::vector<PlanRow>& rows) {
    const uint64_t triangles = dataset.mesh.triangle_count(), vertices = dataset.mesh.vertex_count();
    const auto add = [&](const char* name, std::string shape, uint64_t count, uint64_t bytes, unsigned stages) {
        rows.push_back({name, std::move(shape), count, bytes, stages});
    };
    add_samples(seen, triangles, PlanRow::while_distributing | PlanRow::while_solving, rows);
    add_mesh(dataset, rows);
    constexpr uint64_t places = 24 + 3 + 1, frame = sizeof(Frame), outcome = 3 * 12 + 16 + 12;
    const uint64_t trace = vertices / 16 * uint64_t(request.iterations + 1) * sizeof(TraceRow);
    add("where maps begin, frames, outcomes", "", vertices,
        places * triangles + (12 + frame + outcome) * vertices + trace,
        PlanRow::while_solving | PlanRow::while_writing);
    const uint64_t maps = written_side_by_side(atlas, layout) ? uint64_t(thread_count()) : 1;
    const uint64_t image = largest_image_bytes(atlas, layout);
    add("maps on their way to disk", fmt::format("{} x an image and its file of {} bytes each", maps, image), maps,
        2 * maps * image, PlanRow::while_writing);
}

void add_maps(const Dataset& dataset, const TriangleAtlas& atlas, const LfmOptions& options, const VertexRings& rings,
              Plan& plan) {
    const uint64_t vertices = rings.vertex_count(), terms = uint64_t(options.terms);
    const uint64_t surface = uint64_t(atlas.width()) * uint64_t(atlas.height());
    const uint64_t view = vertices * uint64_t(options.view_side) * uint64_t(options.view_side);
    plan.disk.push_back({"maps",
                         fmt::format("{} terms x (3 surface maps, 1 view map) x 3 floats, before they are "
                                     "compressed",
                                     terms),
                         4 * terms, terms * (3 * surface + view) * 12});
    plan.disk.push_back({"problems", fmt::format("{} vertices x 12 floats", vertices), vertices, vertices * 48});
    plan.disk.push_back({"mesh", "a copy", dataset.mesh.triangle_count(),
                         12 * dataset.mesh.vertex_count() + 13 * dataset.mesh.triangle_count()});
}

}  // namespace

Plan plan_light_field(const Dataset& dataset, const FitRequest& asked, size_t most_views) {
    asked.check();
    require_light_field(dataset);
    const std::vector<uint32_t> views = fitted_views(dataset, asked);
    const FitRequest request = with_sides(asked, dataset, views);
    const LfmOptions options = request.model_options();
    const FitFacts facts = facts_of(request);
    const VertexRings rings(dataset.mesh);
    const TriangleAtlas atlas = surface_atlas(dataset.mesh, options);
    Plan plan;
    add_maps(dataset, atlas, options, rings, plan);
    if (atlas.one_side())
        plan.paper = paper_layout(dataset.mesh.triangle_count(), dataset.mesh.vertex_count(), options.surface_side,
                                  options.view_side);
    if (request.on_fragment_engine()) {
        plan.memory = rows_of(plan_fragment_engine(dataset, atlas, rings, views, options, request.fragment_options(),
                                                   room_of(request.optimizer_options())));
        add_host_images(dataset, request, plan.memory);
        return plan;
    }
    const auto add = [&](std::string name, std::string shape, uint64_t count, uint64_t bytes) {
        plan.memory.push_back({std::move(name), std::move(shape), count, bytes});
    };
    const LfmLayout layout(rings, atlas, options.view_side, options.terms);
    const bool stream = facts.on_engine && !request.on_engine(EngineKind::cpu);
    for (const char* name : {"p", "trial", "d", "g", "trial g", "P", "fresh P"})
        if (stream || name == std::string_view("p"))
            add(name, fmt::format("{} texels x 4 floats", layout.size() / 4), layout.parameter_count(),
                layout.size() * sizeof(float));
    const uint64_t own = stream ? uint64_t(room_of(request.optimizer_options()).vectors) : 0;
    if (own > 0)
        add("vectors of the optimizer", fmt::format("{} x {} texels x 4 floats", own, layout.size() / 4),
            own * layout.parameter_count(), own * layout.size() * sizeof(float));
    const uint64_t pixels = pixels_of(dataset, views);
    if (facts.records) {
        const uint64_t samples = estimate_list(dataset, atlas, request, most_views).samples;
        plan.memory.push_back(held_samples(request, std::max(pixels, samples) * record_bytes(request)));
        plan.disk.push_back({"records, about", fmt::format("samples x {} bytes", record_bytes(request)), samples,
                             samples * record_bytes(request)});
        add_vertex_work(dataset, atlas, rings, request, most_views, plan.memory);
        return plan;
    }
    if (request.on_engine(EngineKind::compute)) {
        const auto arrays = request.redistributes()
                                ? plan_redistribution(dataset, atlas, rings, layout, request.accumulate, views,
                                                      request.stream_options())
                                : plan_cached_samples(atlas, rings, layout, request.accumulate, views.size(),
                                                      estimate_list(dataset, atlas, request, most_views).samples,
                                                      of_8_bits(dataset, request) ? 4 : 8);
        for (const PlanRow& row : rows_of(arrays)) plan.memory.push_back(row);
        if (request.redistributes()) add_host_images(dataset, request, plan.memory);
        return plan;
    }
    if (!request.on_engine(EngineKind::cpu)) {
        const uint64_t footprint = sizeof(Footprint<float>) + (options.loss.weighted() ? sizeof(float) : 0);
        add("view footprints", fmt::format("{} vertices x {} images", rings.vertex_count(), views.size()),
            rings.vertex_count() * views.size(), rings.vertex_count() * views.size() * footprint);
    }
    for (PlanRow& row : plan.memory) row.stages = PlanRow::while_solving | PlanRow::while_writing;
    add_lists(dataset, atlas, layout, estimate_list(dataset, atlas, request, most_views), request, plan.memory);
    add_distributors(dataset, atlas, views, plan.memory);
    add_vertex_work(dataset, atlas, rings, request, most_views, plan.memory);
    return plan;
}

std::vector<PlanRow> paper_layout(size_t triangles, size_t vertices, int surface_side, int view_side) {
    const uint64_t tile = uint64_t(surface_side) * surface_side, view = uint64_t(view_side) * view_side;
    const uint64_t maps = 6 * 3 * triangles * tile, sls = 2 * triangles * tile, views = 6 * vertices * view;
    return {{"surface maps", fmt::format("{} x 3 maps x {} texels x 6 arrays", triangles, tile), maps, 16 * maps},
            {"SLS", fmt::format("{} x {} texels x 2 arrays", triangles, tile), sls, 16 * sls},
            {"view maps", fmt::format("{} x {} texels x 6 arrays", vertices, view), views, 16 * views}};
}

}  // namespace radiafit::fits

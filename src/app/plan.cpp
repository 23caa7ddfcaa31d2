#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "app/family.h"
#include "app/fit_options.h"
#include "base/parallel.h"
#include "compute/compute_plan.h"
#include "cpu/lfm_kernels.h"
#include "cpu/texel_solver.h"
#include "fit/fit_maps.h"
#include "fragment/fragment_plan.h"
#include "fragment/texel_plan.h"
#include "geometry/atlas.h"
#include "geometry/mesh_part.h"
#include "geometry/vertex_rings.h"
#include "reference/solver_memory.h"
#include "samples/interpolated_samples.h"

namespace radiafit {

uint64_t total_bytes(const std::vector<PlanRow>& rows) {
    uint64_t most = 0;
    for (const unsigned stage : {PlanRow::while_distributing, PlanRow::while_solving, PlanRow::while_writing}) {
        uint64_t sum = 0;
        for (const PlanRow& row : rows) sum += row.stages & stage ? row.bytes : 0;
        most = std::max(most, sum);
    }
    return most;
}

namespace {

std::vector<PlanRow> rows_of(const std::vector<PlannedArray>& arrays) {
    std::vector<PlanRow> rows;
    for (const PlannedArray& a : arrays) rows.push_back({a.array, a.shape, a.count, a.bytes});
    return rows;
}

/// Pixels of all fitted views.
uint64_t pixels_of(const Dataset& dataset, const std::vector<uint32_t>& views) {
    uint64_t pixels = 0;
    for (const uint32_t view : views)
        pixels += uint64_t(dataset.views[view].camera.width) * uint64_t(dataset.views[view].camera.height);
    return pixels;
}

/// What fitted views leave.
struct SampleEstimate {
    uint64_t samples = 0;  ///< pixels in texels
    uint64_t groups = 0;   ///< pairs of a tile and an image of which it takes samples
};

/// Every eighth view is looked at, but of few more: eight at least.
size_t step_between(size_t views, size_t most_views) {
    return std::max({size_t(1), std::min<size_t>(8, views / 8), (views + most_views - 1) / most_views});
}

/// From every eighth of the fitted views but eight at least, or from `most_views`. `tiles`, if given, takes the samples
/// apart: counts of `tiles->size()` equal parts of the atlas's texels.
SampleEstimate estimate_samples(const Dataset& dataset, const Atlas& atlas, const FitRequest& request,
                                size_t most_views, std::vector<uint64_t>* tiles = nullptr) {
    const std::vector<uint32_t> views = fitted_views(dataset, request);
    FitRequest on_cpu = request;
    on_cpu.distributor = DistributorKind::cpu;
    const Distributors distributors = make_distributors(atlas, on_cpu);
    const size_t step = step_between(views.size(), most_views);
    const size_t looked_at = (views.size() + step - 1) / step;
    const auto scaled = [&](uint64_t count) { return looked_at ? count * views.size() / looked_at : 0; };
    std::vector<SampleEstimate> seen(looked_at);
    std::vector<std::vector<uint64_t>> parts(size_t(thread_count()), std::vector<uint64_t>(tiles ? tiles->size() : 0));
    std::vector<std::unique_ptr<ImageStream>> streams{size_t(thread_count())};
    parallel_for(looked_at, 1, [&](size_t i, int worker) {
        auto& stream = streams[size_t(worker)];
        if (!stream) stream = std::make_unique<ImageStream>(dataset, StreamSource::disk, TargetSpace::linear);
        TargetImage image;
        Distribution distribution;
        const uint32_t view = views[i * step];
        stream->load_mask(view, image);
        distributors.owned[size_t(worker)]->distribute(dataset.views[view].camera, image, distribution);
        seen[i].samples = distribution.kept_pixels;
        const auto taken = [](uint32_t pixel) { return pixel != no_pixel; };
        for (auto tile = distribution.texel_pixel.begin(); tile != distribution.texel_pixel.end();
             tile += atlas.texels_per_tile())
            seen[i].groups += std::any_of(tile, tile + atlas.texels_per_tile(), taken);
        for (size_t t = 0; tiles && t < distribution.texel_pixel.size(); ++t)
            parts[size_t(worker)][t * tiles->size() / distribution.texel_pixel.size()] +=
                distribution.texel_pixel[t] != no_pixel;
    });
    for (size_t t = 0; tiles && t < tiles->size(); ++t) {
        uint64_t taken = 0;
        for (const auto& part : parts) taken += part[t];
        (*tiles)[t] = scaled(taken);
    }
    SampleEstimate sum;
    for (const SampleEstimate& of_view : seen) sum.samples += of_view.samples, sum.groups += of_view.groups;
    return {scaled(sum.samples), scaled(sum.groups)};
}

/// The same where every texel that an image shows takes a sample of it. tiles: [tiles].
SampleEstimate estimate_interpolated(const Dataset& dataset, const TriangleAtlas& atlas, const FitRequest& request,
                                     size_t most_views, std::vector<uint64_t>* tiles = nullptr) {
    const std::vector<uint32_t> views = fitted_views(dataset, request);
    const size_t step = step_between(views.size(), most_views);
    std::vector<uint32_t> some;
    for (size_t i = 0; i < views.size(); i += step) some.push_back(views[i]);
    if (some.empty()) return {};
    const SampleList seen = interpolated_samples(dataset, atlas, some, request.space);
    const auto scaled = [&](uint64_t count) { return count * views.size() / some.size(); };
    for (size_t t = 0; tiles && t < tiles->size(); ++t)
        (*tiles)[t] = scaled(seen.groups[seen.tile_groups[t + 1]].first - seen.groups[seen.tile_groups[t]].first);
    return {scaled(seen.samples.size()), scaled(seen.groups.size() - 1)};
}

/// What list_samples() finds for a light field map. tiles: [tiles].
SampleEstimate estimate_list(const Dataset& dataset, const TriangleAtlas& atlas, const FitRequest& request,
                             size_t most_views, std::vector<uint64_t>* tiles = nullptr) {
    return request.surface == SurfaceLookup::linear ? estimate_interpolated(dataset, atlas, request, most_views, tiles)
                                                    : estimate_samples(dataset, atlas, request, most_views, tiles);
}

/// What images that stream take of the host.
void add_host_images(const Dataset& dataset, const FitRequest& request, std::vector<PlanRow>& rows) {
    if (request.source != ImageSource::memory) return;
    rows.push_back({"images in host memory", fmt::format("{} views", dataset.views.size()), dataset.views.size(),
                    dataset.image_bytes()});
}

/// What two-step holds of samples, `bytes` in all, while it sorts them.
PlanRow held_samples(const FitRequest& request, uint64_t bytes) {
    return {"samples held in step 1, at most", "--sort-memory, beside an image per thread", 0,
            std::min(request.sort_memory, bytes)};
}

/// Samples on disk by texel, and once more while they are sorted.
constexpr uint64_t texel_record_bytes = 2 * sizeof(TexelRadiance);

}  // namespace

Plan plan_texels(const Dataset& dataset, const FitRequest& request, size_t most_views) {
    require_lights(dataset);
    const TexelOptions options = request.texel_options();
    const uint32_t uses = uses_of(request, dataset.has_grid());
    const auto atlas = texel_atlas(dataset, options.surface_side);
    const uint64_t texels = atlas->texel_count(), n = uint64_t(options.model->parameters);
    Plan plan;
    plan.disk.push_back(
        {"maps",
         fmt::format("{} x {} pixels x {} floats, before they are compressed", atlas->width(), atlas->height(), n + 4),
         n + 4, uint64_t(atlas->width()) * uint64_t(atlas->height()) * 4 * (n + 4)});
    std::vector<PlanRow>& rows = plan.memory;
    if (request.on_fragment_engine()) {
        rows = rows_of(plan_texel_engine(dataset, *atlas, fitted_views(dataset, request), options,
                                         request.fragment_options(), room_of(request.optimizer_options())));
        add_host_images(dataset, request, rows);
        return plan;
    }
    const uint64_t samples = estimate_samples(dataset, *atlas, request, most_views).samples;
    rows.push_back({"results", fmt::format("{} texels x ({} parameters, 4 figures)", texels, n), texels * n,
                    texels * 4 * (n + 4) - 3 * texels});
    if (uses & use::records) {
        rows.push_back(held_samples(request, samples * texel_record_bytes));
        plan.disk.push_back({"records, about", fmt::format("samples x {} bytes", texel_record_bytes), samples,
                             samples * texel_record_bytes});
        return plan;
    }
    rows.push_back({"samples, about", fmt::format("pixels in texels x {} bytes", sizeof(TexelRadiance)), samples,
                    samples * sizeof(TexelRadiance)});
    if (request.on_engine(EngineKind::compute)) {
        const uint64_t maps = n / 3 + 1, vectors = uint64_t(room_of(request.optimizer_options()).vector_count());
        rows.push_back({"vectors, about", fmt::format("{} x {} texels x {} x 4 floats", vectors, texels, maps),
                        vectors * texels * n, vectors * texels * maps * 16});
        rows.push_back({"samples that count, about", "once more, and for the device", 2 * samples, 48 * samples});
        rows.push_back({"texels", "their surface, samples and numbers", texels, 160 * texels});
    } else if (uses & use::engine && !request.levenberg_marquardt())
        rows.push_back(
            {"engine, about", "shaded samples in batches of eight texels; p, trial, d, g, trial g, P, fresh P", samples,
             texel_solvers(*options.model).stream_bytes(texels, samples, room_of(request.optimizer_options()))});
    return plan;
}

namespace {

/// Of a sample in the records of two-step, which stands in three vertices' blocks, and once more in a file in which it
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
    if (solver.uses & use::ceres) estimate_list(dataset, atlas, request, most_views, &tiles);
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

/// What finds the pixels of texels: of each thread an image, what its pixels see, and its texels' pixels.
void add_distributors(const Dataset& dataset, const TriangleAtlas& atlas, const std::vector<uint32_t>& views,
                      std::vector<PlanRow>& rows) {
    uint64_t pixels = 0;
    for (const uint32_t view : views)
        pixels =
            std::max(pixels, uint64_t(dataset.views[view].camera.width) * uint64_t(dataset.views[view].camera.height));
    const uint64_t threads = std::min(uint64_t(thread_count()), uint64_t(views.size()));
    const uint64_t vertices = visible_mesh(dataset.mesh).vertex_count();
    constexpr uint64_t pixel_bytes = 8 + 12 + 4 + 4, vertex_bytes = 24, texel_bytes = 4, tile_bytes = 1;
    const uint64_t bytes = pixels * pixel_bytes + vertices * vertex_bytes + atlas.texel_count() * texel_bytes +
                           atlas.tile_count() * tile_bytes;
    rows.push_back({"images on their way to texels", fmt::format("{} threads x {} bytes", threads, bytes), threads,
                    threads * bytes, PlanRow::while_distributing});
}

/// What a fit on the processor holds beside its parameters: the list of samples, which are brought into their tiles'
/// order once, tables of the mesh, and a map on its way to disk.
void add_lists(const Dataset& dataset, const TriangleAtlas& atlas, const LfmLayout& layout, const SampleEstimate& seen,
               const FitRequest& request, std::vector<PlanRow>& rows) {
    const uint64_t triangles = dataset.mesh.triangle_count(), vertices = dataset.mesh.vertex_count();
    const auto add = [&](const char* name, std::string shape, uint64_t count, uint64_t bytes, unsigned stages) {
        rows.push_back({name, std::move(shape), count, bytes, stages});
    };
    const uint64_t list = seen.samples * sizeof(Sample) + seen.groups * sizeof(SampleGroup) + 4 * triangles;
    const auto shape = [&](size_t group) {
        return fmt::format("pixels x {} bytes, {} groups x {} bytes", sizeof(Sample), seen.groups, group);
    };
    add("samples, about", shape(sizeof(SampleGroup)), seen.samples, list,
        PlanRow::while_distributing | PlanRow::while_solving);
    add("samples by image, about", shape(8), seen.samples, seen.samples * sizeof(Sample) + seen.groups * 8,
        PlanRow::while_distributing);
    constexpr uint64_t of_triangle = 12 + 24 + 2, of_vertex = 12 + 12 + 4;  // mesh, rings, atlas
    add("mesh and its rings", fmt::format("{} triangles, {} vertices", triangles, vertices), triangles,
        of_triangle * triangles + of_vertex * vertices, PlanRow::while_all);
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

/// Whether all samples' colours are of 8 bits, as stored.
bool of_8_bits(const Dataset& dataset, const FitRequest& request) {
    return request.surface == SurfaceLookup::nearest &&
           ImageStream(dataset, StreamSource::disk, request.space).bits() == 8;
}

}  // namespace

Plan plan_light_field(const Dataset& dataset, const FitRequest& asked, size_t most_views) {
    asked.check();
    require_light_field(dataset);
    const std::vector<uint32_t> views = fitted_views(dataset, asked);
    const FitRequest request = with_sides(asked, dataset, views);
    const LfmOptions options = request.model_options();
    const uint32_t uses = uses_of(request);
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
    const bool stream = uses & use::engine && !request.on_engine(EngineKind::cpu);
    for (const char* name : {"p", "trial", "d", "g", "trial g", "P", "fresh P"})
        if (stream || name == std::string_view("p"))
            add(name, fmt::format("{} texels x 4 floats", layout.size() / 4), layout.parameter_count(),
                layout.size() * sizeof(float));
    const uint64_t own = stream ? uint64_t(room_of(request.optimizer_options()).vectors) : 0;
    if (own > 0)
        add("vectors of the optimizer", fmt::format("{} x {} texels x 4 floats", own, layout.size() / 4),
            own * layout.parameter_count(), own * layout.size() * sizeof(float));
    const uint64_t pixels = pixels_of(dataset, views);
    if (uses & use::records) {
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

namespace {
/// Of colours by view direction with n numbers per texel.
Plan plan_by_view(const Dataset& dataset, const FitRequest& request, size_t most_views, uint64_t n) {
    request.check();
    require_light_field(dataset);
    const TriangleAtlas atlas(dataset.mesh, request.model.surface_side);
    const uint64_t texels = atlas.texel_count();
    const uint64_t image = uint64_t(atlas.width()) * uint64_t(atlas.height()) * sizeof(float);
    Plan plan;
    plan.disk.push_back(
        {"maps",
         fmt::format("{} x {} pixels x {} floats, before they are compressed", atlas.width(), atlas.height(), n + 4),
         n + 4, image * (n + 4)});
    const std::vector<uint32_t> views = fitted_views(dataset, request);
    const VertexRings rings(dataset.mesh);
    add_lists(dataset, atlas, LfmLayout(rings, atlas, 2, 1), estimate_interpolated(dataset, atlas, request, most_views),
              request, plan.memory);
    add_distributors(dataset, atlas, views, plan.memory);
    plan.memory.push_back({"results", fmt::format("{} texels x ({} parameters, 4 figures)", texels, n), texels * n,
                           texels * 4 * (n + 4), PlanRow::while_solving | PlanRow::while_writing});
    return plan;
}
}  // namespace

Plan plan_sg(const Dataset& dataset, const FitRequest& request, size_t most_views) {
    return plan_by_view(dataset, request, most_views, uint64_t(sg_parameters(request.lobes)));
}

Plan plan_view_basis(const Dataset& dataset, const FitRequest& request, size_t most_views) {
    const uint64_t n = 3 * uint64_t(request.view_basis.rank);
    Plan plan = plan_by_view(dataset, request, most_views, n);
    const uint64_t blocks = uint64_t(request.view_basis.blocks), of_block = view_terms * (n / 3 + 3);
    plan.disk.push_back({"basis, about", fmt::format("{} blocks x {} floats", blocks, of_block), blocks * of_block,
                         blocks * of_block * sizeof(float)});
    const uint64_t texels = TriangleAtlas(dataset.mesh, request.model.surface_side).used_texels();
    plan.memory.push_back({"texels to learn from", fmt::format("{} texels x 8 bytes", texels), texels, 2 * 8 * texels,
                           PlanRow::while_solving});
    return plan;
}

std::vector<PlanRow> paper_layout(size_t triangles, size_t vertices, int surface_side, int view_side) {
    const uint64_t tile = uint64_t(surface_side) * surface_side, view = uint64_t(view_side) * view_side;
    const uint64_t maps = 6 * 3 * triangles * tile, sls = 2 * triangles * tile, views = 6 * vertices * view;
    return {{"surface maps", fmt::format("{} x 3 maps x {} texels x 6 arrays", triangles, tile), maps, 16 * maps},
            {"SLS", fmt::format("{} x {} texels x 2 arrays", triangles, tile), sls, 16 * sls},
            {"view maps", fmt::format("{} x {} texels x 6 arrays", vertices, view), views, 16 * views}};
}

}  // namespace radiafit

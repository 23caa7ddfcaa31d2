#include <algorithm>

#include "base/clock.h"
#include "cpu/vertex_solver.h"
#include "fitting/family.h"
#include "fitting/fit_options.h"
#include "fitting/solvers/solver.h"
#include "geometry/atlas.h"
#include "geometry/mesh_part.h"
#include "geometry/vertex_rings.h"

namespace radiafit::fits {
namespace {

/// `count` of `all` things, or all of them, spread evenly.
std::vector<uint32_t> spread(size_t count, size_t all) {
    std::vector<uint32_t> out;
    count = std::min(count, all);
    for (size_t i = 0; i < count; ++i) out.push_back(uint32_t(i * all / count));
    return out;
}

std::vector<uint32_t> some_of(const std::vector<uint32_t>& views, size_t count) {
    std::vector<uint32_t> out;
    for (const uint32_t k : spread(count, views.size())) out.push_back(views[k]);
    return out;
}

/// Runs of consecutive vertices, as a thread takes them, spread over the mesh.
std::vector<uint32_t> some_vertices(size_t all) {
    constexpr size_t run = 16, runs = 64;
    if (all <= run * runs) return spread(all, all);
    std::vector<uint32_t> out;
    for (const uint32_t first : spread(runs, all / run))
        for (uint32_t k = 0; k < run; ++k) out.push_back(uint32_t(run) * first + k);
    return out;
}

/// What the system takes to give so much memory, and this program to clear it.
double seconds_to_touch(uint64_t bytes) {
    constexpr uint64_t some = 64 << 20;
    const Stopwatch clock;
    const std::vector<float> cleared(some / sizeof(float), 0.0f);
    const double seconds = cleared.back() + clock.wall_s();
    return seconds * double(bytes) / double(some);
}

/// As if what the images of `list` show were seen over and over, by each of `views`.
SampleList repeated(const SampleList& list, const std::vector<uint32_t>& views) {
    SampleList out;
    out.views = views;
    out.scale = list.scale;
    const size_t images = list.image_count();
    for (size_t tile = 0; tile < list.tile_count(); ++tile) {
        out.tile_groups.push_back(uint32_t(out.groups.size()));
        for (size_t first = 0; first < views.size(); first += images)
            for (uint32_t g = list.tile_groups[tile]; g < list.tile_groups[tile + 1]; ++g) {
                const size_t image = first + list.groups[g].image;
                if (image >= views.size()) break;
                out.groups.push_back({uint32_t(image), out.samples.size()});
                const auto samples = list.of_group(g);
                out.samples.insert(out.samples.end(), samples.begin(), samples.end());
            }
    }
    out.tile_groups.push_back(uint32_t(out.groups.size()));
    out.groups.push_back({uint32_t(views.size()), out.samples.size()});
    return out;
}

/// The vertices alone, among their triangles; the whole hides them in images.
Dataset with_vertices(const Dataset& dataset, const VertexRings& rings, const std::vector<uint32_t>& vertices) {
    Dataset out = dataset;
    out.mesh = part_around({std::shared_ptr<const Mesh>(), &dataset.mesh}, rings, vertices);
    auto around = std::make_shared<Surroundings>(*out.mesh.surroundings);
    around->blocks.assign(out.mesh.vertex_count(), 0);
    out.mesh.surroundings = around;
    return out;
}

}  // namespace

std::optional<PlannedSeconds> plan_seconds(const Dataset& dataset, const FitRequest& asked) {
    if (&family_of(asked) != &light_field_maps || find_solver(asked.solver).solve != solve_stream ||
        !asked.on_engine(EngineKind::cpu))
        return {};
    const std::vector<uint32_t> views = fitted_views(dataset, asked);
    FitRequest request = with_sides(asked, dataset, views);
    request.distributor = DistributorKind::cpu;
    // as many that vertices which few images see are seen here too
    const std::vector<uint32_t> few = some_of(views, 8), more = some_of(views, 32);
    const VertexRings rings(dataset.mesh);

    PlannedSeconds out;
    uint64_t parameter_bytes = 0;
    {  // what an image takes more than the first few
        const TriangleAtlas atlas = surface_atlas(dataset.mesh, request.model_options());
        parameter_bytes = LfmLayout(rings, atlas, request.model.view_side, request.model.terms).size() * sizeof(float);
        const auto seconds_of = [&](const std::vector<uint32_t>& images) {
            const Stopwatch clock;
            distribute(dataset, atlas, request, images);
            return clock.wall_s();
        };
        out.distributing = seconds_of(few);
        if (more.size() > few.size())
            out.distributing += std::max(0.0, seconds_of(more) - out.distributing) * double(views.size() - few.size()) /
                                double(more.size() - few.size());
    }
    const std::vector<uint32_t> vertices = some_vertices(rings.vertex_count());
    const Dataset part = with_vertices(dataset, rings, vertices);
    if (const TileSides all = request.model.sides) {
        auto sides = std::make_shared<std::vector<uint8_t>>();
        for (const uint32_t t : part.mesh.surroundings->triangles) sides->push_back((*all)[t]);
        request.model.sides = sides;
    }
    request.part = true;  // none of the few images need show any of the vertices
    const LfmOptions options = request.model_options();
    const TriangleAtlas atlas = surface_atlas(part.mesh, options);
    const SampleList samples = repeated(distribute(part, atlas, request, more).list, views);
    const Stopwatch clock;
    solve_vertices(part, atlas, VertexRings(part.mesh), samples, options, request.vertex_solver_options());
    out.solving = clock.wall_s() * double(rings.vertex_count()) / double(vertices.size());
    out.solving += seconds_to_touch(parameter_bytes);
    return out;
}

}  // namespace radiafit::fits

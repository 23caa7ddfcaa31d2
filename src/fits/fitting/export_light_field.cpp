// The problems of a light field map, and its parameters, for other people's solvers: docs/problems.md.
#include <nlohmann/json.hpp>

#include "cpu/lfm_problem.h"
#include "fitting/family.h"
#include "model/lfm_start.h"
#include "model/penalty.h"

namespace radiafit::fits {
namespace {

constexpr const char* light_field_formulas = R"json({
    "look_up": "h[v,i,k] = sum over j = 0..3 of view_weights[v,i,j] view[v, view_texel[v,i] + (0, 1, m, m + 1)[j], k]",
    "place": "a[s,c] = triangle_maps[t,c] + texel[s], with sample s in a group of triangle t and image i",
    "residual": "r[s,c] = sum over k of surface[a,k] h[v,i,k] - barycentric[a] radiance[s], v = triangle_vertices[t,c]",
    "data": "E = 1/2 sum over s, c of inverse_density[v] weight[v,i] r[s,c]^2",
    "laplacian": "(L x)[a] = sum over n of x[a] - x[neighbours[a,n]]",
    "smoothness": "1/2 lambda_surface |L surface|^2 + 1/2 sum over v of lambda_view[v] |L view[v]|^2",
    "bounds": "sum over p of the surface and view maps of term 0, with q = p - min(max(p, lower), upper): where q is not 0, 1/2 mu q^2, or printed: mu (p - lower) (p - upper)",
    "objective": "data + smoothness + bounds, of each vertex and colour channel apart",
    "prediction": "of a sample: sum over c and k of surface[a,k] h[v,i,k]"
})json";

/// What the problems are made from, whatever the samples.
struct Ground {
    const Dataset& dataset;
    LfmOptions options;
    TriangleAtlas atlas;
    VertexRings rings;
    LfmLayout layout;

    Ground(const Dataset& dataset, const LfmOptions& options)
        : dataset(dataset),
          options(options),
          atlas(surface_atlas(dataset.mesh, options)),
          rings(dataset.mesh),
          layout(rings, atlas, options.view_side, options.terms) {}
};

/// Surface texels before vertex v, over all its predecessors' maps; of vertex_count(): all.
uint64_t first_texel(const LfmLayout& layout, size_t v) {
    return (layout.offset(v) - v * size_t(layout.view_texels()) * layout.stride()) / layout.stride();
}

void write_groups(const std::string& split, const SampleList& list, ProblemFolder& out) {
    const uint64_t groups = list.groups.size() - 1;
    std::vector<int64_t> first;
    std::vector<int32_t> triangle, image;
    for (const SampleGroup& group : list.groups) first.push_back(int64_t(group.first));
    for (size_t t = 0; t < list.tile_count(); ++t)
        for (uint32_t g = list.tile_groups[t]; g < list.tile_groups[t + 1]; ++g) {
            triangle.push_back(int32_t(t));
            image.push_back(int32_t(list.groups[g].image));
        }
    out.write(split + "_group_first", {groups + 1}, first, "where each group's samples begin, and the last ones end");
    out.write(split + "_group_triangle", {groups}, triangle, "the triangle whose samples the group has");
    out.write(split + "_group_image", {groups}, image, "the image that they are of");
}

void write_samples(const std::string& split, const SampleList& list, ProblemFolder& out) {
    const uint64_t samples = list.samples.size();
    auto radiance = out.open<float>(split + "_radiance", {samples, 3}, "red, green, blue: what the samples are");
    for (const Sample& s : list.samples)
        for (const uint16_t channel : s.rgb) radiance.write(float(channel) * list.scale);
    radiance.close();
    auto texel = out.open<int32_t>(split + "_texel", {samples}, "the texel of its triangle that a sample is in");
    for (const Sample& s : list.samples) texel.write(s.local);
    texel.close();
}

void write_look_ups(const Ground& ground, const std::string& split, const SampleList& list, ProblemFolder& out) {
    const std::vector<Vec3f>& positions = ground.dataset.mesh.positions;
    const uint64_t vertices = positions.size(), images = list.image_count();
    auto texel = out.open<int32_t>(split + "_view_texel", {vertices, images},
                                   "the lower left of the four texels of a vertex's view map that an image looks up");
    auto weights = out.open<float>(split + "_view_weights", {vertices, images, 4},
                                   "of these texels: (x, y), (x + 1, y), (x, y + 1), (x + 1, y + 1)");
    auto weight = out.open<float>(split + "_weight", {vertices, images}, "of a vertex's squared residuals in an image");
    const std::vector<Frame> frames = vertex_frames(ground.dataset.mesh);
    for (size_t v = 0; v < vertices; ++v)
        for (const uint32_t view : list.views) {
            const Vec3d eye = ground.dataset.views[view].camera.center();
            const ViewFootprint f =
                view_footprint(frames[v], positions[v], eye, ground.options.view_side, ground.options.lookup);
            texel.write(f.texel);
            weights.write(f.weight);
            weight.write(float(view_weight(frames[v], positions[v], eye, ground.options.loss.weights)));
        }
    texel.close();
    weights.close();
    weight.close();
}

void write_split(const Ground& ground, const std::string& split, const SampleList& list, ProblemFolder& out) {
    write_groups(split, list, out);
    write_samples(split, list, out);
    write_look_ups(ground, split, list, out);
}

/// Which maps there are, and what is known of their texels.
void write_maps(const Ground& ground, ProblemFolder& out) {
    const LfmLayout& layout = ground.layout;
    const uint64_t triangles = ground.atlas.tile_count(), vertices = layout.problem_count();
    const uint64_t texels = first_texel(layout, vertices);
    std::vector<int32_t> corners;
    std::vector<int64_t> maps(3 * triangles, -1), first;
    for (const auto& triangle : ground.dataset.mesh.triangles)
        corners.insert(corners.end(), triangle.begin(), triangle.end());
    auto barycentric =
        out.open<float>("barycentric", {texels}, "weight of a surface map's vertex at its texel's centre");
    auto neighbours = out.open<int64_t>("surface_neighbours", {texels, 4},
                                        "of a surface texel in its map; itself where it has fewer than four");
    for (size_t v = 0; v < vertices; ++v) {
        int64_t map = int64_t(first_texel(layout, v));
        first.push_back(map);
        for (const Corner& corner : ground.rings.ring(v)) {
            const TriangleTile& tile = ground.atlas.tile(corner.triangle);
            maps[3 * size_t(corner.triangle) + corner.corner] = map;
            for (uint32_t local = 0; local < tile.texels(); ++local) {
                barycentric.write(tile.barycentric(local)[corner.corner]);
                const auto around = MapNeighbours::triangle(tile.side()).of(local);
                for (size_t i = 0; i < 4; ++i) neighbours.write(map + (i < around.size() ? around[i] : local));
            }
            map += tile.texels();
        }
    }
    first.push_back(int64_t(texels));
    barycentric.close();
    neighbours.close();
    out.write("triangle_vertices", {triangles, 3}, corners, "the vertices at a triangle's corners");
    out.write("triangle_maps", {triangles, 3}, maps,
              "the first surface texel of the map that a corner has on its triangle; -1: the triangle has no area");
    out.write("vertex_texels", {vertices + 1}, first, "where a vertex's surface texels begin, and the last ones end");

    const uint64_t view_texels = uint64_t(layout.view_texels());
    const MapNeighbours view = MapNeighbours::square(layout.view_side());
    std::vector<int32_t> view_neighbours;
    for (size_t texel = 0; texel < view_texels; ++texel) {
        const auto around = view.of(texel);
        for (size_t i = 0; i < 4; ++i) view_neighbours.push_back(int32_t(i < around.size() ? around[i] : texel));
    }
    out.write("view_neighbours", {view_texels, 4}, view_neighbours, "of a view map's texel, likewise");
}

void write_scales(const Ground& ground, const ProblemStatistics& statistics, ProblemFolder& out) {
    const uint64_t vertices = ground.layout.problem_count();
    std::vector<float> density(vertices, 0.0f), lambda(3 * vertices, 0.0f);
    for (size_t v = 0; v < vertices; ++v) {
        if (statistics.samples[v] == 0) continue;
        const size_t texels = ground.layout.surface_texels(v);
        density[v] = float(inverse_density(ground.options, texels, statistics.samples[v]));
        for (size_t c = 0; c < 3; ++c)
            lambda[3 * v + c] = scaled_lambda_view(ground.options, texels, statistics.mean[3 * v + c]);
    }
    out.write("inverse_density", {vertices}, density,
              "a vertex's surface texels over its training samples; 0: it has none, and is nobody's problem");
    out.write("lambda_view", {vertices, 3}, lambda, "weight of the view map's smoothness, for each colour channel");
}

void write_parameters(const LfmLayout& layout, const std::vector<float>& p, const std::string& prefix,
                      ProblemFolder& out) {
    const uint64_t vertices = layout.problem_count(), terms = uint64_t(layout.terms());
    auto surface =
        out.open<float>(prefix + "surface", {first_texel(layout, vertices), terms, 3},
                        "the surface maps: vertex by vertex, triangle by triangle around it, texel by texel");
    auto view = out.open<float>(prefix + "view", {vertices, uint64_t(layout.view_texels()), terms, 3},
                                "the view maps, row by row");
    for (size_t v = 0; v < vertices; ++v) {
        for (size_t at = layout.offset(v); at < layout.view_offset(v); at += 4) surface.write({&p[at], 3});
        for (size_t at = layout.view_offset(v); at < layout.offset(v + 1); at += 4) view.write({&p[at], 3});
    }
    surface.close();
    view.close();
}

void describe_model(const LfmOptions& o, TargetSpace space, SurfaceLookup surface, ProblemFolder& out) {
    using Json = nlohmann::ordered_json;
    out.tell("model", json_string(lfm_name));
    out.tell("space", json_string(space == TargetSpace::stored ? "stored" : "linear"));
    out.tell("maps", Json{{"terms", o.terms},
                          {"surface_side", o.surface_side},
                          {"view_side", o.view_side},
                          {"lookup", to_string(o.lookup)},
                          {"surface_lookup", to_string(surface)}}
                         .dump());
}

}  // namespace

void export_light_field_problems(const Dataset& dataset, const FitRequest& asked, ProblemFolder& out) {
    require_light_field(dataset);
    const std::vector<uint32_t> training = fitted_views(dataset, asked), held_out = judged_views(dataset, asked);
    const FitRequest request = with_sides(asked, dataset, training);
    const Ground ground(dataset, request.model_options());
    const LfmOptions& o = ground.options;
    describe_model(o, request.space, request.surface, out);
    out.describe_views(training, held_out);
    out.tell("objective", nlohmann::ordered_json{{"lambda_surface", o.lambda_surface},
                                                 {"mu", o.mu},
                                                 {"lower", o.lower},
                                                 {"upper", o.upper},
                                                 {"printed_bounds", o.mode == Mode::paper}}
                              .dump());
    out.tell("formulas", light_field_formulas);
    write_maps(ground, out);
    {
        const SampleList samples = distribute(dataset, ground.atlas, request, training).list;
        LfmProblem<float> problem(dataset, ground.atlas, ground.rings, samples, o);
        const ProblemStatistics statistics = problem.count();
        write_scales(ground, statistics, out);
        write_parameters(ground.layout, lfm_start(ground.layout, statistics.mean, request.seed), "start_", out);
        write_split(ground, "training", samples, out);
    }
    write_split(ground, "held_out", list_samples(dataset, ground.atlas, request, held_out), out);
}

void export_parameters(const LightFieldFit& fit, const Mesh& mesh, ProblemFolder& out) {
    const LfmLayout layout(VertexRings(mesh), surface_atlas(mesh, fit.options), fit.options.view_side,
                           fit.options.terms);
    std::vector<float> p = fit.parameters;
    for (size_t problem = 0; problem < fit.problem_count(); ++problem) {
        if (fit.status[problem] != Status::no_samples) continue;
        const size_t v = problem / 3;  // a vertex without samples contributes nothing
        for (size_t at = layout.offset(v) + problem % 3; at < layout.view_offset(v); at += 4) p[at] = 0;
    }
    describe_model(fit.options, fit.space, fit.surface, out);
    write_parameters(layout, p, "", out);
}

}  // namespace radiafit::fits

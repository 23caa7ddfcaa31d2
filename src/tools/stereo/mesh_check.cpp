#include "stereo/mesh_check.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "base/statistics.h"
#include "base/wording.h"
#include "capture/colmap.h"
#include "capture/colmap_points.h"
#include "capture/coverage.h"
#include "capture/mesh_file.h"
#include "geometry/mesh_part.h"
#include "geometry/raster.h"
#include "stereo/masks.h"
#include "stereo/mesh_border.h"
#include "stereo/mesh_cut.h"
#include "stereo/stereo_folder.h"
#include "stereo/vertex_evidence.h"

namespace radiafit::tools {
namespace fs = std::filesystem;
namespace {

constexpr double largest_distance = 0.005, near_distance = 0.01;  // of the diagonal
constexpr double least_share = 0.03, least_overlap = 0.7;
constexpr double most_in_free_space = 0.02;  // of the area

double median_or_0(std::vector<double> values) { return values.empty() ? 0 : median(std::move(values)); }

/// Distances of the points that the camera sees amid the mesh from the planes of the triangles there.
std::vector<double> distances(const Mesh& mesh, const Camera& camera, const std::vector<RasterPixel>& pixels,
                              const std::vector<Vec3d>& points) {
    std::vector<double> found;
    for (const Vec3d& point : points) {
        const Vec3d p = camera.project(point);
        if (!(p.z() > 0 && p.x() >= 0 && p.y() >= 0 && p.x() < camera.width && p.y() < camera.height)) continue;
        const uint32_t triangle = pixels[size_t(p.y()) * size_t(camera.width) + size_t(p.x())].triangle;
        if (triangle == no_triangle) continue;
        const auto& [a, b, c] = mesh.triangles[triangle];
        const Vec3d corner = mesh.positions[a].cast<double>();
        const Vec3d normal =
            (mesh.positions[b].cast<double>() - corner).cross(mesh.positions[c].cast<double>() - corner).normalized();
        found.push_back(std::abs(normal.dot(point - corner)));
    }
    return found;
}

/// Lines of border edges that hang together.
size_t count_borders(const Mesh& mesh) {
    const auto edges = border_edges(mesh);
    const std::vector<uint32_t> line = connected(mesh.vertex_count(), edges);
    std::vector<uint8_t> is_line(mesh.vertex_count(), 0);
    for (const auto& edge : edges) is_line[line[edge[0]]] = 1;
    return size_t(std::ranges::count(is_line, 1));
}

MeshCheck::Surface look_at_surface(const Mesh& mesh, const std::vector<PlaneMap>& maps) {
    const CutOptions usual;  // of cut_mesh(), which is held to the same
    const std::vector<std::vector<uint8_t>> no_masks(maps.size());
    const VertexEvidence evidence = evidence_of(mesh, maps, no_masks, usual.depth);
    MeshCheck::Surface out;
    out.inside_out = evidence.inside_out();
    double area = 0;
    for (const auto& t : mesh.triangles) {
        const double own = (mesh.positions[t[1]] - mesh.positions[t[0]])
                               .cross(mesh.positions[t[2]] - mesh.positions[t[0]])
                               .cast<double>()
                               .norm();
        area += own;
        for (const uint32_t v : t) {
            const bool free = evidence.in_free_space(v), supported = evidence.supported[v] >= uint32_t(usual.support);
            (free ? out.in_free_space : supported ? out.supported : out.unknown) += own / 3;
        }
    }
    for (double* share : {&out.supported, &out.in_free_space, &out.unknown}) *share /= std::max(area, 1e-300);
    return out;
}

void find_what_is_poor(MeshCheck& check, bool masked) {
    const auto say = [&](std::string line) { check.poor.push_back(std::move(line)); };
    if (check.points == 0)
        say("no point of the calibration is seen amid the mesh: bring the mesh into the calibration's frame");
    if (check.distance > largest_distance)
        say(
            fmt::format("the calibration's points are {:.2f} % of the mesh's diagonal away from it in the median, more "
                        "than {} %: bring the mesh into the calibration's frame, or take more photographs of what is "
                        "shiny or has no texture",
                        100 * check.distance, 100 * largest_distance));
    if (check.share < least_share)
        say(
            fmt::format("the mesh covers {:.1f} % of the photographs in the median, less than {} %: go nearer, so that "
                        "the object fills the photographs, or give the mesh yourself",
                        100 * check.share, 100 * least_share));
    if (check.surface && check.surface->inside_out) say(inside_out_text);
    if (check.surface && check.surface->in_free_space > most_in_free_space)
        say(
            fmt::format("{:.1f} % of the mesh's area is in front of what photographs see there, more than {} %: {}, or "
                        "remove flaps and loose pieces in a mesh editor",
                        100 * check.surface->in_free_space, 100 * most_in_free_space,
                        at_command_line("cut it by `radiafit capture cut-mesh`", "cut it by cut_mesh()")));
    if (masked && check.overlap < least_overlap)
        say(
            fmt::format("mesh and masks agree on {:.0f} % of what either has in the median, less than {} %: in masks "
                        "white is the object; or give the mesh yourself",
                        100 * check.overlap, 100 * least_overlap));
}

}  // namespace

MeshCheck check_mesh(const MeshCheckInput& input) {
    const Calibration model = read_colmap(input.model);
    const std::vector<SparsePoint> points = read_colmap_points(input.model, model);
    const Mesh mesh = read_mesh_file(input.mesh).mesh;
    const std::vector<fs::path> mask_files = find_mask_files(model, input.images, input.masks);
    const size_t count = model.images.size();
    std::vector<std::vector<Vec3d>> seen(count);
    for (const SparsePoint& point : points)
        for (const uint32_t i : point.images) seen[i].push_back(point.position);

    MeshCheck check;
    check.vertices = mesh.vertex_count();
    check.triangles = mesh.triangle_count();
    check.photographs.resize(count);
    std::vector<std::vector<double>> away(count);
    std::vector<Rasterizer> rasters(static_cast<size_t>(thread_count()));
    parallel_for(count, 1, [&](size_t i, int worker) {
        const Camera& camera = model.images[i].camera;
        Rasterizer& raster = rasters[size_t(worker)];
        raster.draw(mesh, camera);
        away[i] = distances(mesh, camera, raster.pixels(), seen[i]);
        const std::vector<uint8_t> mask = load_mask(mask_files, i, camera);
        Coverage coverage;
        for (size_t p = 0; p < raster.pixels().size(); ++p) {
            const bool hit = raster.pixels()[p].triangle != no_triangle, object = !mask.empty() && mask[p];
            coverage.mesh += hit, coverage.object += object, coverage.both += hit && object;
        }
        check.photographs[i] = {model.images[i].name, double(coverage.mesh) / double(raster.pixels().size()),
                                mask.empty() ? 0 : coverage.overlap()};
    });
    const Box box = bounding_box(mesh.positions);
    const double diagonal = (box.high - box.low).cast<double>().norm();
    std::vector<double> all, shares, overlaps;
    for (const auto& list : away)
        for (const double d : list) all.push_back(d / diagonal);
    for (const MeshCheck::Photograph& p : check.photographs) shares.push_back(p.share), overlaps.push_back(p.overlap);
    check.points = all.size();
    check.distance = median_or_0(all);
    const auto near = std::count_if(all.begin(), all.end(), [](double d) { return d <= near_distance; });
    check.near_share = all.empty() ? 0 : double(near) / double(all.size());
    check.share = median_or_0(shares);
    check.overlap = median_or_0(overlaps);
    const std::vector<uint32_t> piece = pieces_of(mesh);
    std::vector<uint8_t> used(mesh.vertex_count(), 0);
    for (const auto& t : mesh.triangles) used[piece[t[0]]] = 1;
    check.pieces = size_t(std::ranges::count(used, 1));
    check.borders = count_borders(mesh);
    check.border_length = border_length(mesh) / diagonal;
    if (!input.depths.empty()) check.surface = look_at_surface(mesh, read_planes(input.depths, model));
    find_what_is_poor(check, !input.masks.empty());
    return check;
}

}  // namespace radiafit::tools

#include "stereo/mesh_check.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "capture/colmap.h"
#include "capture/colmap_points.h"
#include "capture/coverage.h"
#include "capture/mesh_file.h"
#include "geometry/mesh_part.h"
#include "geometry/raster.h"
#include "stereo/masks.h"

namespace radiafit::tools {
namespace fs = std::filesystem;
namespace {

constexpr double largest_distance = 0.005, near_distance = 0.01;  // of the diagonal
constexpr double least_share = 0.03, least_overlap = 0.7;

double median(std::vector<double> values) {
    if (values.empty()) return 0;
    const auto middle = values.begin() + ptrdiff_t(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

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
    if (masked && check.overlap < least_overlap)
        say(
            fmt::format("mesh and masks agree on {:.0f} % of what either has in the median, less than {} %: in masks "
                        "white is the object; or give the mesh yourself",
                        100 * check.overlap, 100 * least_overlap));
}

}  // namespace

MeshCheck check_mesh(const fs::path& file, const fs::path& folder, const fs::path& images, const fs::path& masks) {
    const Calibration model = read_colmap(folder);
    const std::vector<SparsePoint> points = read_colmap_points(folder, model);
    const Mesh mesh = read_mesh_file(file).mesh;
    const std::vector<fs::path> mask_files = find_mask_files(model, images, masks);
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
    check.distance = median(all);
    const auto near = std::count_if(all.begin(), all.end(), [](double d) { return d <= near_distance; });
    check.near_share = all.empty() ? 0 : double(near) / double(all.size());
    check.share = median(shares);
    check.overlap = median(overlaps);
    find_what_is_poor(check, !masks.empty());
    return check;
}

}  // namespace radiafit::tools

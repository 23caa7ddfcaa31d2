#include "publish/first_view.h"

#include <algorithm>
#include <cmath>

#include "dataset/view_directions.h"

namespace radiafit::tools {
namespace {

constexpr size_t most_vertices = 4096;  // that are looked for in a picture, evenly among all
constexpr double slack = 0.01;          // of the vertices: views that show so many fewer count as whole, too
constexpr double near = 0.26;           // radians, 15 degrees: at which a view counts half

/// The share of the mesh's vertices that lie within the picture, hidden or not.
double share_within(const Camera& camera, const Mesh& mesh) {
    const size_t step = std::max<size_t>(1, mesh.vertex_count() / most_vertices);
    size_t within = 0, all = 0;
    for (size_t v = 0; v < mesh.vertex_count(); v += step, ++all) {
        const Vec3d p = camera.project(mesh.positions[v].cast<double>());
        within += p.z() > 0 && p.x() >= 0 && p.y() >= 0 && p.x() <= camera.width && p.y() <= camera.height;
    }
    return all > 0 ? double(within) / double(all) : 1;
}

double closeness(const Vec3d& a, const Vec3d& b) {
    const double angle = std::acos(std::clamp(a.dot(b), -1.0, 1.0));
    return 1 / (1 + angle * angle / (near * near));
}

/// How many training views there are around this one, by its camera and its lamp.
double company(const Dataset& dataset, const std::vector<uint32_t>& training, const View& view, const Vec3d& centre) {
    double sum = 0;
    for (const uint32_t t : training) {
        const View& other = dataset.views[t];
        double each = closeness(view.direction_to_camera(centre), other.direction_to_camera(centre));
        if (view.light && other.light)
            each *= closeness(view.light->direction_from(centre), other.light->direction_from(centre));
        sum += each;
    }
    return sum;
}

/// How near the lamp is to where drawings have it: halfway up, from the upper left.
double drawn_light(const View& view, const Grid& grid, const Vec3d& centre) {
    if (!view.light) return 0;
    const Vec3d wanted =
        (grid.normal() - 0.5 * std::sqrt(2) * (grid.right.normalized() + grid.down.normalized())).normalized();
    return wanted.dot(view.light->direction_from(centre));
}

}  // namespace

size_t first_view(const Dataset& dataset, const std::vector<uint32_t>& training, const std::vector<uint32_t>& views) {
    const Vec3d centre = surface_centre(dataset.mesh, dataset.grid);
    std::vector<double> whole(views.size(), 1);
    if (!dataset.has_grid())
        for (size_t i = 0; i < views.size(); ++i) whole[i] = share_within(dataset.views[views[i]].camera, dataset.mesh);
    const double least = whole.empty() ? 0 : std::ranges::max(whole) - slack;
    size_t best = 0;
    double most = -2;
    for (size_t i = 0; i < views.size(); ++i) {
        if (whole[i] < least) continue;
        const View& view = dataset.views[views[i]];
        const double value =
            dataset.has_grid() ? drawn_light(view, dataset.grid, centre) : company(dataset, training, view, centre);
        if (value > most) most = value, best = i;
    }
    return best;
}

}  // namespace radiafit::tools

#include "stereo/mesh_cut.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <mutex>
#include <numeric>
#include <vector>

#include "base/error.h"
#include "base/parallel.h"
#include "geometry/raster.h"

namespace radiafit::tools {
namespace {

using Marks = std::vector<uint8_t>;  ///< of vertices

/// What one photograph says of each vertex.
struct Seen {
    Marks framed, masked_out, supported;
};

Seen look_at_vertices(const Mesh& mesh, const PlaneMap& map, const std::vector<uint8_t>& mask, double most_difference,
                      Rasterizer& raster) {
    constexpr double hidden_behind = 0.005;  // of the depth: so far behind the mesh a vertex is hidden
    const Camera& camera = map.camera;
    raster.draw(mesh, camera);
    const size_t count = mesh.vertex_count();
    Seen seen{Marks(count, 0), Marks(count, 0), Marks(count, 0)};
    for (size_t v = 0; v < count; ++v) {
        const Vec3d p = camera.project(mesh.positions[v].cast<double>());
        if (!(p.z() > 0 && p.x() >= 0 && p.y() >= 0 && p.x() < camera.width && p.y() < camera.height)) continue;
        seen.framed[v] = 1;
        const size_t at = size_t(p.y()) * size_t(camera.width) + size_t(p.x());
        seen.masked_out[v] = !mask.empty() && !mask[at];
        const double front = raster.inverse_depth()[at];
        if (front == 0 || p.z() * front > 1 + hidden_behind || !map.known(at)) continue;
        const double inverse_depth = map.planes[at].dot(ray_of(camera, p.x(), p.y()));
        seen.supported[v] = std::abs(inverse_depth * p.z() - 1) <= most_difference;
    }
    return seen;
}

/// Marks every vertex that shares a triangle with one that has `mark`, where `allowed`.
void spread(const Mesh& mesh, Marks& marks, uint8_t mark, const Marks& allowed) {
    const Marks before = marks;
    for (const auto& t : mesh.triangles)
        if (before[t[0]] == mark || before[t[1]] == mark || before[t[2]] == mark)
            for (const uint32_t v : t)
                if (allowed[v]) marks[v] = mark;
}

/// Grown by so many rings, then shrunk by as many; never beyond `allowed`, never less than before.
Marks closed(const Mesh& mesh, const Marks& kept, const Marks& allowed, int rings) {
    Marks grown = kept;
    for (int r = 0; r < rings; ++r) spread(mesh, grown, 1, allowed);
    Marks removable(kept.size());
    for (size_t v = 0; v < kept.size(); ++v) removable[v] = !kept[v];
    for (int r = 0; r < rings; ++r) spread(mesh, grown, 0, removable);
    return grown;
}

/// For each vertex the least vertex of its component, through triangles that are kept.
std::vector<uint32_t> components(const Mesh& mesh, const Marks& kept) {
    std::vector<uint32_t> parent(kept.size());
    std::iota(parent.begin(), parent.end(), 0u);
    const auto root = [&](uint32_t v) {
        while (parent[v] != v) v = parent[v] = parent[parent[v]];
        return v;
    };
    for (const auto& t : mesh.triangles) {
        if (!kept[t[0]] || !kept[t[1]] || !kept[t[2]]) continue;
        for (int k = 1; k < 3; ++k) {
            const uint32_t a = root(t[0]), b = root(t[size_t(k)]);
            parent[std::max(a, b)] = std::min(a, b);
        }
    }
    for (uint32_t v = 0; v < parent.size(); ++v) parent[v] = root(v);
    return parent;
}

void keep_largest(const Mesh& mesh, Marks& kept) {
    const std::vector<uint32_t> component = components(mesh, kept);
    std::vector<double> area(kept.size(), 0);
    for (const auto& t : mesh.triangles) {
        if (!kept[t[0]] || !kept[t[1]] || !kept[t[2]]) continue;
        const Vec3f a = mesh.positions[t[1]] - mesh.positions[t[0]], b = mesh.positions[t[2]] - mesh.positions[t[0]];
        area[component[t[0]]] += double(a.cross(b).norm());
    }
    const auto largest = uint32_t(std::max_element(area.begin(), area.end()) - area.begin());
    for (size_t v = 0; v < kept.size(); ++v) kept[v] = kept[v] && component[v] == largest;
}

Mesh part_that_is(const Mesh& mesh, const Marks& kept) {
    Mesh part;
    std::vector<uint32_t> place(kept.size());
    Marks used(kept.size(), 0);
    for (const auto& t : mesh.triangles)
        if (kept[t[0]] && kept[t[1]] && kept[t[2]]) {
            part.triangles.push_back(t);
            for (const uint32_t v : t) used[v] = 1;
        }
    for (size_t v = 0; v < kept.size(); ++v)
        if (used[v]) {
            place[v] = uint32_t(part.positions.size());
            part.positions.push_back(mesh.positions[v]);
        }
    for (auto& t : part.triangles)
        for (uint32_t& v : t) v = place[v];
    return part;
}

size_t count_of(const Marks& marks) { return size_t(std::count(marks.begin(), marks.end(), 1)); }

}  // namespace

Mesh cut_mesh(const Mesh& mesh, std::span<const PlaneMap> maps, std::span<const std::vector<uint8_t>> masks,
              const SearchBall& region, const CutOptions& options, CutReport& report) {
    const size_t count = mesh.vertex_count();
    std::vector<uint32_t> framed(count, 0), masked_out(count, 0), supported(count, 0);
    std::vector<Rasterizer> rasters(static_cast<size_t>(thread_count()));
    std::mutex adding;
    parallel_for(maps.size(), 1, [&](size_t i, int worker) {
        const Seen seen = look_at_vertices(mesh, maps[i], masks[i], options.depth, rasters[size_t(worker)]);
        const std::lock_guard lock(adding);
        for (size_t v = 0; v < count; ++v)
            framed[v] += seen.framed[v], masked_out[v] += seen.masked_out[v], supported[v] += seen.supported[v];
    });
    report = {};
    report.vertices = count;
    Marks allowed(count, 0), kept(count, 0);
    for (size_t v = 0; v < count; ++v) {
        if ((mesh.positions[v].cast<double>() - region.centre).norm() > region.radius)
            ++report.off_region;
        else if (double(masked_out[v]) > options.outside * double(framed[v]))
            ++report.off_masks;
        else
            allowed[v] = 1;
        kept[v] = allowed[v] && supported[v] >= uint32_t(options.support);
    }
    kept = closed(mesh, kept, allowed, options.close);
    report.unsupported = count_of(allowed) - count_of(kept);
    const size_t before = count_of(kept);
    keep_largest(mesh, kept);
    report.apart = before - count_of(kept);
    Mesh part = part_that_is(mesh, kept);
    if (part.triangles.empty())
        throw UserError(
            "nothing of the mesh is left: the depth maps, and the masks if there are any, agree with none of "
            "it; give the mesh yourself, or more photographs that overlap");
    return part;
}

}  // namespace radiafit::tools

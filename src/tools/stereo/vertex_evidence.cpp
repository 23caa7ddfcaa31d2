#include "stereo/vertex_evidence.h"

#include <cmath>
#include <mutex>

#include "base/parallel.h"
#include "geometry/raster.h"

namespace radiafit::tools {
namespace {

using Marks = std::vector<uint8_t>;  ///< of vertices

struct Seen {
    Marks framed, masked_out, supported, seen_past;
    size_t facing = 0, averted = 0;
};

/// Whether all depths within a few pixels are known, and beyond z: what is thinner than the patches that depths are
/// found by (stereo/patch.h) may be missing in them.
bool all_beyond(const PlaneMap& map, int x, int y, double z) {
    constexpr int around = 2;
    const Camera& camera = map.camera;
    if (x < around || y < around || x + around >= camera.width || y + around >= camera.height) return false;
    for (int row = y - around; row <= y + around; ++row)
        for (int column = x - around; column <= x + around; ++column) {
            const size_t at = size_t(row) * size_t(camera.width) + size_t(column);
            if (!map.known(at)) return false;
            const auto inverse_depth = double(map.planes[at].dot(ray_of(camera, column + 0.5, row + 0.5)));
            if (!(inverse_depth * z < 1)) return false;
        }
    return true;
}

Seen look_at_vertices(const Mesh& mesh, std::span<const Vec3f> normals, const PlaneMap& map,
                      const std::vector<uint8_t>& mask, double tolerance, Rasterizer& raster) {
    constexpr double hidden_behind = 0.005;  // of the depth: so far behind the mesh a vertex is hidden
    const Camera& camera = map.camera;
    raster.draw(mesh, camera);
    const size_t count = mesh.vertex_count();
    const Vec3f eye = camera.center().cast<float>();
    Seen seen{Marks(count, 0), Marks(count, 0), Marks(count, 0), Marks(count, 0)};
    for (size_t v = 0; v < count; ++v) {
        const Vec3d p = camera.project(mesh.positions[v].cast<double>());
        if (!(p.z() > 0 && p.x() >= 0 && p.y() >= 0 && p.x() < camera.width && p.y() < camera.height)) continue;
        seen.framed[v] = 1;
        const int x = int(p.x()), y = int(p.y());
        const size_t at = size_t(y) * size_t(camera.width) + size_t(x);
        seen.masked_out[v] = !mask.empty() && !mask[at];
        seen.seen_past[v] = all_beyond(map, x, y, p.z() * (1 + tolerance));
        if (!map.known(at)) continue;
        const double inverse_depth = map.planes[at].dot(ray_of(camera, p.x(), p.y()));
        if (!(std::abs(inverse_depth * p.z() - 1) <= tolerance)) continue;
        ++(normals[v].dot(eye - mesh.positions[v]) > 0 ? seen.facing : seen.averted);
        const double front = raster.inverse_depth()[at];
        seen.supported[v] = front != 0 && p.z() * front <= 1 + hidden_behind;
    }
    return seen;
}

}  // namespace

VertexEvidence evidence_of(const Mesh& mesh, std::span<const PlaneMap> maps,
                           std::span<const std::vector<uint8_t>> masks, double tolerance) {
    const size_t count = mesh.vertex_count();
    const std::vector<uint32_t> zeros(count, 0);
    VertexEvidence out{zeros, zeros, zeros, zeros};
    const std::vector<Vec3f> normals = vertex_normals(mesh);
    std::vector<Rasterizer> rasters(static_cast<size_t>(thread_count()));
    std::mutex adding;
    parallel_for(maps.size(), 1, [&](size_t i, int worker) {
        const Seen seen = look_at_vertices(mesh, normals, maps[i], masks[i], tolerance, rasters[size_t(worker)]);
        const std::lock_guard lock(adding);
        out.facing += seen.facing, out.averted += seen.averted;
        for (size_t v = 0; v < count; ++v) {
            out.framed[v] += seen.framed[v], out.masked_out[v] += seen.masked_out[v];
            out.supported[v] += seen.supported[v], out.seen_past[v] += seen.seen_past[v];
        }
    });
    return out;
}

}  // namespace radiafit::tools

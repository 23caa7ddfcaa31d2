#include "eval/seen_by.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <mutex>

#include "base/parallel.h"
#include "eval/pixel_areas.h"

namespace radiafit {

namespace {

/// Calls see(view, pixels, mask or null, depths, seen) for every view; `seen` is what it fills in.
template <class See>
std::vector<std::vector<uint32_t>> seen_in_views(const Dataset& dataset, const ImageStream& stream,
                                                 const std::vector<uint32_t>& views, size_t count, const See& see) {
    std::vector<std::vector<uint32_t>> out(count);
    struct Tools {
        ImageStream stream;
        Rasterizer rasterizer = {};
        TargetImage mask = {};
    };
    std::vector<std::unique_ptr<Tools>> tools;
    tools.resize(size_t(thread_count()));
    std::mutex adding;
    parallel_for(views.size(), 1, [&](size_t i, int worker) {
        auto& tool = tools.at(size_t(worker));
        if (!tool) tool = std::make_unique<Tools>(stream.another());
        const View& view = dataset.views[views[i]];
        if (view.mask_offset) tool->stream.load_mask(views[i], tool->mask);
        const std::vector<RasterPixel> pixels = seen_pixels(dataset, view, tool->rasterizer);
        std::vector<bool> seen(count);
        see(view, pixels, view.mask_offset ? &tool->mask : nullptr, tool->rasterizer, seen);
        const std::lock_guard lock(adding);
        for (size_t t = 0; t < seen.size(); ++t)
            if (seen[t]) out[t].push_back(views[i]);
    });
    for (std::vector<uint32_t>& of : out) std::ranges::sort(of);
    return out;
}

/// Whether a point at this depth is in front of, or on, what a pixel around it shows.
bool on_surface(const Rasterizer& drawn, const Camera& camera, int column, int row, double depth) {
    constexpr double slack = 1.005;
    float least = std::numeric_limits<float>::infinity();  // 1 / depth
    for (int y = std::max(0, row - 1); y <= std::min(camera.height - 1, row + 1); ++y)
        for (int x = std::max(0, column - 1); x <= std::min(camera.width - 1, column + 1); ++x) {
            const float inverse = drawn.inverse_depth()[size_t(y) * size_t(camera.width) + size_t(x)];
            if (inverse > 0) least = std::min(least, inverse);
        }
    return std::isfinite(least) && depth * double(least) <= slack;
}

}  // namespace

std::vector<std::vector<uint32_t>> views_that_see(const Dataset& dataset, const ImageStream& stream,
                                                  const std::vector<uint32_t>& views) {
    const size_t count = dataset.has_grid() ? dataset.grid.texel_count() : size_t(dataset.mesh.triangle_count());
    return seen_in_views(dataset, stream, views, count,
                         [&](const View&, const std::vector<RasterPixel>& pixels, const TargetImage* mask,
                             const Rasterizer&, auto& seen) {
                             for (size_t k = 0; k < pixels.size(); ++k)
                                 if (pixels[k].triangle != no_triangle && (!mask || mask->masked_in(k)))
                                     seen[pixels[k].triangle] = true;
                         });
}

std::vector<std::vector<uint32_t>> views_that_see_vertices(const Dataset& dataset, const ImageStream& stream,
                                                           const std::vector<uint32_t>& views) {
    const Mesh& mesh = dataset.mesh;
    const std::vector<Vec3f> normals = vertex_normals(mesh);
    return seen_in_views(
        dataset, stream, views, mesh.vertex_count(),
        [&](const View& view, const std::vector<RasterPixel>& pixels, const TargetImage* mask, const Rasterizer& drawn,
            auto& seen) {
            for (size_t k = 0; k < pixels.size(); ++k)
                if (pixels[k].triangle != no_triangle && (!mask || mask->masked_in(k)))
                    for (const uint32_t v : mesh.triangles[pixels[k].triangle]) seen[v] = true;
            const Camera& camera = view.camera;
            const Vec3d eye = camera.center();
            for (size_t v = 0; v < mesh.vertex_count(); ++v) {
                const Vec3d place = mesh.positions[v].cast<double>();
                if (seen[v] || !(normals[v].cast<double>().dot(eye - place) > 0)) continue;
                const Vec3d at = camera.project(place);
                if (!(at.z() > 0 && at.x() >= 0 && at.y() >= 0 && at.x() < camera.width && at.y() < camera.height))
                    continue;
                const int column = int(at.x()), row = int(at.y());
                if (mask && !mask->masked_in(size_t(row) * size_t(camera.width) + size_t(column))) continue;
                seen[v] = on_surface(drawn, camera, column, row, at.z());
            }
        });
}

}  // namespace radiafit

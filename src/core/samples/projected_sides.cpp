#include "samples/projected_sides.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "geometry/raster.h"

namespace radiafit {
namespace {

double area_in(const Camera& camera, const Mesh& mesh, uint32_t triangle) {
    Vec3d corner[3];
    for (size_t c = 0; c < 3; ++c)
        corner[c] = camera.project(mesh.positions[mesh.triangles[triangle][c]].cast<double>());
    const Vec3d a = corner[1] - corner[0], b = corner[2] - corner[0];
    return std::min(0.5 * std::abs(a.x() * b.y() - a.y() * b.x()), double(camera.width) * camera.height);
}

int side_of(double texels) {
    // n(n+1)/2 >= texels
    const double side = std::ceil((std::sqrt(1 + 8 * texels) - 1) / 2);
    return int(std::clamp(side, double(least_side), double(largest_side)));
}

}  // namespace

std::vector<double> projected_areas(const Dataset& dataset, const std::vector<uint32_t>& views) {
    const Mesh& mesh = dataset.mesh;
    std::vector<std::vector<double>> of_worker(static_cast<size_t>(thread_count()),
                                               std::vector<double>(mesh.triangle_count(), 0.0));
    std::vector<Rasterizer> rasterizers(of_worker.size());
    parallel_for(views.size(), 1, [&](size_t i, int worker) {
        const Camera& camera = dataset.views[views[i]].camera;
        Rasterizer& rasterizer = rasterizers[size_t(worker)];
        rasterizer.draw(mesh, camera);
        std::vector<bool> seen(mesh.triangle_count(), false);
        for (const RasterPixel& pixel : rasterizer.pixels())
            if (pixel.triangle != no_triangle) seen[pixel.triangle] = true;
        for (uint32_t t = 0; t < mesh.triangle_count(); ++t)
            if (seen[t])
                of_worker[size_t(worker)][t] = std::max(of_worker[size_t(worker)][t], area_in(camera, mesh, t));
    });
    std::vector<double> areas(mesh.triangle_count(), 0.0);
    for (const std::vector<double>& part : of_worker)
        for (size_t t = 0; t < areas.size(); ++t) areas[t] = std::max(areas[t], part[t]);
    return areas;
}

TileSides sides_by_area(std::span<const double> areas, double texels_per_pixel) {
    std::vector<uint8_t> sides;
    for (const double area : areas) sides.push_back(uint8_t(side_of(texels_per_pixel * area)));
    return std::make_shared<const std::vector<uint8_t>>(std::move(sides));
}

int largest_of(const TileSides& sides) {
    return sides->empty() ? least_side : *std::max_element(sides->begin(), sides->end());
}

double density_for(std::span<const double> areas, double mean_texels, double limit) {
    const auto mean = [&](double density) {
        double sum = 0;
        for (const double area : areas) sum += TriangleTile::texels_of(side_of(density * area));
        return sum / double(areas.size());
    };
    double low = 1e-4, high = limit;
    for (int i = 0; i < 60; ++i) {
        const double middle = std::sqrt(low * high);
        (mean(middle) < mean_texels ? low : high) = middle;
    }
    const double unit = std::pow(10, std::floor(std::log10(high)) - 3);
    return std::min(limit, std::round(high / unit) * unit);
}

}  // namespace radiafit

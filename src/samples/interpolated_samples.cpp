#include "samples/interpolated_samples.h"

#include <Eigen/Geometry>
#include <cmath>
#include <memory>

#include "base/parallel.h"
#include "geometry/mesh_part.h"
#include "geometry/raster.h"
#include "samples/image_samples.h"

namespace radiafit {
namespace {

constexpr double depth_tolerance = 0.005;  // of the distance

/// One thread's tools.
class Interpolator {
public:
    Interpolator(const TriangleAtlas& atlas, ImageStream stream) : atlas_(atlas), stream_(std::move(stream)) {}

    void collect(uint32_t view, const Camera& camera, ImageSamples<Sample>& out) {
        stream_.load(view, image_);
        rasterizer_.draw(visible_mesh(atlas_.mesh()), camera);
        const Vec3d eye = camera.center();
        for (uint32_t tile = 0; tile < atlas_.tile_count(); ++tile) {
            if (atlas_.degenerate(tile) || !faces(tile, eye)) continue;
            const size_t before = out.samples.size();
            for (uint32_t local = 0; local < atlas_.tile(tile).texels(); ++local) add(camera, tile, local, out.samples);
            if (out.samples.size() == before) continue;
            out.blocks.push_back(tile);
            out.first.push_back(uint32_t(before));
        }
        out.first.push_back(uint32_t(out.samples.size()));
    }

private:
    bool faces(uint32_t tile, const Vec3d& eye) const {
        const Mesh& mesh = atlas_.mesh();
        const auto& [a, b, c] = mesh.triangles[tile];
        const Vec3d p = mesh.positions[a].cast<double>();
        const Vec3d normal = (mesh.positions[b].cast<double>() - p).cross(mesh.positions[c].cast<double>() - p);
        return normal.dot(eye - p) > 0;
    }

    /// Whether the pixel sees the surface at this depth.
    bool sees(size_t pixel, double inverse_depth) const {
        const double seen = double(rasterizer_.inverse_depth()[pixel]);
        return image_.masked_in(pixel) && std::abs(seen - inverse_depth) <= depth_tolerance * inverse_depth;
    }

    void add(const Camera& camera, uint32_t tile, uint32_t local, std::vector<Sample>& out) const {
        const Vec3d p = camera.project(atlas_.position(tile, local).cast<double>());
        if (!(p.z() > 0 && p.x() >= 0 && p.x() < image_.width && p.y() >= 0 && p.y() < image_.height)) return;
        const double inverse_depth = 1 / p.z();
        if (!sees(size_t(p.y()) * size_t(image_.width) + size_t(p.x()), inverse_depth)) return;
        const double x = p.x() - 0.5, y = p.y() - 0.5;
        const int left = int(std::floor(x)), top = int(std::floor(y));
        double sum[3] = {}, weights = 0;
        for (int corner = 0; corner < 4; ++corner) {
            const int column = left + (corner & 1), row = top + (corner >> 1);
            if (column < 0 || column >= image_.width || row < 0 || row >= image_.height) continue;
            const size_t pixel = size_t(row) * size_t(image_.width) + size_t(column);
            if (!sees(pixel, inverse_depth)) continue;
            const double weight = (1 - std::abs(x - column)) * (1 - std::abs(y - row));
            const auto channels = image_.channel16(pixel);
            for (size_t c = 0; c < 3; ++c) sum[c] += weight * channels[c];
            weights += weight;
        }
        if (!(weights > 0)) return;
        const auto value = [&](size_t c) { return uint16_t(std::lround(sum[c] / weights)); };
        out.push_back({{value(0), value(1), value(2)}, uint16_t(local)});
    }

    const TriangleAtlas& atlas_;
    ImageStream stream_;
    TargetImage image_;
    Rasterizer rasterizer_;
};

}  // namespace

SampleList interpolated_samples(const Dataset& dataset, const TriangleAtlas& atlas, const std::vector<uint32_t>& views,
                                TargetSpace space) {
    const ImageStream stream(dataset, StreamSource::disk, space);
    std::vector<std::unique_ptr<Interpolator>> workers{size_t(thread_count())};
    std::vector<ImageSamples<Sample>> images(views.size());
    parallel_for(views.size(), 1, [&](size_t k, int worker) {
        auto& own = workers[size_t(worker)];
        if (!own) own = std::make_unique<Interpolator>(atlas, stream.another());
        own->collect(views[k], dataset.views[views[k]].camera, images[k]);
    });
    return list_by_tile(atlas.tile_count(), views, stream.scale16(), images);
}

}  // namespace radiafit

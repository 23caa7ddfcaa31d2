#include "samples/interpolated_samples.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include "base/parallel.h"
#include "geometry/mesh_part.h"
#include "geometry/raster.h"
#include "samples/image_samples.h"

namespace radiafit {
namespace {

constexpr double least_tolerance = 0.005;  // of the depth

/// One thread's tools.
class Interpolator {
public:
    Interpolator(const TriangleAtlas& atlas, ImageStream stream) : atlas_(atlas), stream_(std::move(stream)) {}

    void collect(uint32_t view, const Camera& camera, ImageSamples<Sample>& out) {
        stream_.load(view, image_);
        rasterizer_.draw(visible_mesh(atlas_.mesh()), camera);
        tolerance_ = std::max(least_tolerance, 1 / std::min(camera.fx, camera.fy));
        for (uint32_t tile = 0; tile < atlas_.tile_count(); ++tile) {
            const auto plane = atlas_.degenerate(tile) ? std::nullopt : plane_of(tile, camera);
            if (!plane) continue;
            const size_t before = out.samples.size();
            for (uint32_t local = 0; local < atlas_.tile(tile).texels(); ++local)
                add(camera, tile, local, *plane, out.samples);
            if (out.samples.size() == before) continue;
            out.blocks.push_back(tile);
            out.first.push_back(uint32_t(before));
        }
        out.first.push_back(uint32_t(out.samples.size()));
    }

private:
    /// 1 / z over the image of a triangle's plane: a x + b y + c at pixel coordinates (x, y).
    struct InverseDepth {
        double a, b, c;
        double at(double x, double y) const { return a * x + b * y + c; }
    };
    /// None for a triangle that faces away.
    std::optional<InverseDepth> plane_of(uint32_t tile, const Camera& camera) const {
        const Mesh& mesh = atlas_.mesh();
        Vec3d corner[3];
        for (size_t k = 0; k < 3; ++k)
            corner[k] = camera.to_camera(mesh.positions[mesh.triangles[tile][k]].cast<double>());
        const Vec3d normal = (corner[1] - corner[0]).cross(corner[2] - corner[0]);
        const double offset = normal.dot(corner[0]);
        if (!(offset < 0)) return {};
        const double a = normal.x() / (camera.fx * offset), b = normal.y() / (camera.fy * offset);
        return InverseDepth{a, b, normal.z() / offset - a * camera.cx - b * camera.cy};
    }

    /// Whether the pixel sees the plane, or what goes on from it.
    bool sees(int column, int row, const InverseDepth& plane) const {
        const size_t pixel = size_t(row) * size_t(image_.width) + size_t(column);
        const double expected = plane.at(column + 0.5, row + 0.5), seen = double(rasterizer_.inverse_depth()[pixel]);
        return image_.masked_in(pixel) && std::abs(seen - expected) <= tolerance_ * seen;
    }

    void add(const Camera& camera, uint32_t tile, uint32_t local, const InverseDepth& plane,
             std::vector<Sample>& out) const {
        const Vec3d p = camera.project(atlas_.position(tile, local).cast<double>());
        if (!(p.z() > 0 && p.x() >= 0 && p.x() < image_.width && p.y() >= 0 && p.y() < image_.height)) return;
        if (!sees(int(p.x()), int(p.y()), plane)) return;
        const double x = p.x() - 0.5, y = p.y() - 0.5;
        const int left = int(std::floor(x)), top = int(std::floor(y));
        double sum[3] = {}, weights = 0;
        for (int corner = 0; corner < 4; ++corner) {
            const int column = left + (corner & 1), row = top + (corner >> 1);
            if (column < 0 || column >= image_.width || row < 0 || row >= image_.height) continue;
            if (!sees(column, row, plane)) continue;
            const size_t pixel = size_t(row) * size_t(image_.width) + size_t(column);
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
    double tolerance_ = 0;  ///< of the depth
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

#pragma once
#include <cstdint>
#include <functional>
#include <vector>

#include "geometry/camera.h"
#include "geometry/mesh.h"
#include "geometry/raster.h"
#include "synthetic/paint.h"
#include "synthetic/surface_light.h"

namespace radiafit {

/// A synthetic object, ready to be photographed.
struct Scene {
    const Mesh& mesh;
    const Paint& paint;
    const SurfaceLight& light;
};

/// One image in linear radiance.
struct LinearImage {
    std::vector<Vec3f> pixels;        ///< [height * width], row 0 on top; black where nothing is seen
    std::vector<uint8_t> foreground;  ///< [height * width] 1 where the pixel's centre sees the mesh
};

/// Where on the surface a raster pixel's centre is.
Vec3f point_of(const Mesh& mesh, const RasterPixel& seen);

/// Draws with `samples` (odd) samples per pixel and axis, each the `radiance` of what it sees. A pixel whose centre
/// sees the mesh averages only samples that do: the object's colour, up to its silhouette. The other pixels fade to
/// black.
void render_samples(Rasterizer& rasterizer, const Mesh& mesh, const Camera& camera, int samples, LinearImage& image,
                    const std::function<Vec3f(const RasterPixel& seen)>& radiance);

/// Renders with `samples` (odd) samples per pixel and axis, by render_samples(). Scratch space is kept: one per thread.
class ViewRenderer {
public:
    void render(const Scene& scene, const Camera& camera, int samples, LinearImage& image);

private:
    Rasterizer rasterizer_;
};

}  // namespace radiafit

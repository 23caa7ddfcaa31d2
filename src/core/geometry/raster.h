#pragma once
#include <cstdint>
#include <vector>

#include "geometry/camera.h"
#include "geometry/mesh.h"

namespace radiafit {

/// What one pixel centre sees.
struct RasterPixel {
    uint32_t triangle = no_triangle;
    float b1 = 0, b2 = 0;  ///< perspective-correct barycentric weights of the triangle's 2nd and 3rd vertex
};

/// The one CPU rasterizer: nearest front-facing triangle at every pixel centre, row 0 on top.
/// Degenerate triangles and triangles with a vertex at camera depth <= 1e-6 are dropped. Ties in depth: lower index.
/// Vertices are rounded to 2^-14 of a pixel, so that edge tests are exact (images up to 8192 pixels wide) and, by the
/// top-left rule, a pixel centre on a shared edge belongs to exactly one of its triangles.
/// Scratch space is kept between calls, so one Rasterizer serves one thread.
class Rasterizer {
public:
    /// pixels() is then [height * width], row-major.
    void draw(const Mesh& mesh, const Camera& camera);
    const std::vector<RasterPixel>& pixels() const { return pixels_; }
    const std::vector<float>& inverse_depth() const { return inverse_depth_; }  ///< 1/z, 0 where nothing is seen

private:
    std::vector<RasterPixel> pixels_;
    std::vector<float> inverse_depth_;
    std::vector<Vec3d> projected_;  ///< [V] pixel x and y from the image's middle, 1/z; 1/z = 0: not in front
};

}  // namespace radiafit

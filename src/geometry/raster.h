#pragma once
#include <cstdint>
#include <vector>

#include "geometry/camera.h"
#include "geometry/mesh.h"

namespace radiafit {

inline constexpr uint32_t no_triangle = 0xffffffffu;

/// What one pixel centre sees.
struct RasterPixel {
    uint32_t triangle = no_triangle;
    float b1 = 0, b2 = 0;  ///< perspective-correct barycentric weights of the triangle's 2nd and 3rd vertex
};

/// The one CPU rasterizer: nearest front-facing triangle at every pixel centre, row 0 on top.
/// Degenerate triangles and triangles with a vertex at camera depth <= 1e-6 are dropped. Ties in depth: lower index.
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
    std::vector<Eigen::Vector3d> projected_;  ///< per vertex: pixel x, pixel y, 1/z
};

}  // namespace radiafit

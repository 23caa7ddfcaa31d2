#include "samples/surface_photograph.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace radiafit {
namespace {

constexpr double least_tolerance = 0.005;  // of the depth

}  // namespace

void SurfacePhotograph::load(ImageStream& stream, uint32_t view, const Camera& camera, const Mesh& mesh,
                             Rasterizer& rasterizer) {
    camera_ = camera;
    stream.load(view, image_);
    rasterizer.draw(mesh, camera);
    inverse_depth_ = rasterizer.inverse_depth();
    tolerance_ = std::max(least_tolerance, 1 / std::min(camera.fx, camera.fy));
}

std::optional<SurfacePhotograph::Plane> SurfacePhotograph::plane_of(const Mesh& mesh, uint32_t triangle) const {
    Vec3d corner[3];
    for (size_t k = 0; k < 3; ++k)
        corner[k] = camera_.to_camera(mesh.positions[mesh.triangles[triangle][k]].cast<double>());
    const Vec3d normal = (corner[1] - corner[0]).cross(corner[2] - corner[0]);
    const double offset = normal.dot(corner[0]);
    if (!(offset < 0)) return {};
    const double a = normal.x() / (camera_.fx * offset), b = normal.y() / (camera_.fy * offset);
    return Plane{a, b, normal.z() / offset - a * camera_.cx - b * camera_.cy};
}

bool SurfacePhotograph::sees(int column, int row, const Plane& plane) const {
    const size_t pixel = size_t(row) * size_t(image_.width) + size_t(column);
    const double expected = plane.at(column + 0.5, row + 0.5), seen = double(inverse_depth_[pixel]);
    return image_.masked_in(pixel) && std::abs(seen - expected) <= tolerance_ * seen;
}

SurfacePhotograph::Colour SurfacePhotograph::colour(double x, double y, const Plane& plane) const {
    x -= 0.5;
    y -= 0.5;
    const int left = int(std::floor(x)), top = int(std::floor(y));
    Colour out{};
    for (int corner = 0; corner < 4; ++corner) {
        const int column = left + (corner & 1), row = top + (corner >> 1);
        if (column < 0 || column >= image_.width || row < 0 || row >= image_.height) continue;
        if (!sees(column, row, plane)) continue;
        const size_t pixel = size_t(row) * size_t(image_.width) + size_t(column);
        const double weight = (1 - std::abs(x - column)) * (1 - std::abs(y - row));
        const auto channels = image_.channel16(pixel);
        for (size_t c = 0; c < 3; ++c) out.rgb[c] += weight * channels[c];
        out.share += weight;
    }
    for (double& value : out.rgb)
        if (out.share > 0) value /= out.share;
    return out;
}

}  // namespace radiafit

#pragma once
#include <optional>
#include <vector>

#include "dataset/image_stream.h"
#include "geometry/camera.h"
#include "geometry/raster.h"

namespace radiafit {

/// A photograph and how deep its camera sees: looked up at places of the surface, where it shows them.
class SurfacePhotograph {
public:
    /// mesh: all that the photograph shows. The rasterizer is room to work in.
    void load(ImageStream& stream, uint32_t view, const Camera& camera, const Mesh& mesh, Rasterizer& rasterizer);

    /// A triangle's plane as the camera sees it: 1 / z = a x + b y + c at pixel coordinates (x, y).
    struct Plane {
        double a, b, c;
        double at(double x, double y) const { return a * x + b * y + c; }
    };
    /// The triangle's plane; none if it faces away.
    std::optional<Plane> plane_of(const Mesh& mesh, uint32_t triangle) const;

    /// Whether a pixel lies within the mask and sees the plane, within half a percent of the depth or a pixel's width:
    /// the triangle itself, or a neighbour that goes on from it.
    bool sees(int column, int row, const Plane& plane) const;

    /// Interpolated bilinearly between the centres of the four pixels around a point, of those that see the plane.
    struct Colour {
        double rgb[3];  ///< in units of TargetImage::channel16()
        double share;   ///< of the bilinear weights that these pixels have; 0: none sees it, and rgb is 0
    };
    Colour colour(double x, double y, const Plane& plane) const;

    const Camera& camera() const { return camera_; }
    const TargetImage& image() const { return image_; }
    bool contains(double x, double y) const { return x >= 0 && x < image_.width && y >= 0 && y < image_.height; }
    const std::vector<float>& inverse_depth() const { return inverse_depth_; }  ///< Rasterizer's

private:
    Camera camera_;
    TargetImage image_;
    std::vector<float> inverse_depth_;  ///< [height][width]
    double tolerance_ = 0;              ///< of the depth
};

}  // namespace radiafit

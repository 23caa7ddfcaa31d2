#pragma once
#include <optional>
#include <span>
#include <vector>

#include "geometry/light.h"
#include "lamps/highlight.h"

/// Where lamps are, by their mirror images on glossy spheres.
namespace radiafit::tools {

/// How a picture of the plane z = 0 lies in the world, which has its origin in the picture's middle, x to the right, y
/// up and z towards the camera.
struct PictureFrame {
    int width = 0, height = 0;      ///< pixels
    double pixel = 1;               ///< a pixel's side, world units
    std::optional<Vec3d> eye = {};  ///< where the camera is; none: far away along z

    Vec3d plane_point(const Vec2d& place) const {
        return {(place.x() - 0.5 * width) * pixel, (0.5 * height - place.y()) * pixel, 0};
    }
    Vec2d place_of(const Vec3d& plane_point) const {
        return {plane_point.x() / pixel + 0.5 * width, 0.5 * height - plane_point.y() / pixel};
    }
    Vec3d direction_to_camera(const Vec3d& x) const {
        return eye ? Vec3d((*eye - x).normalized()) : Vec3d(Vec3d::UnitZ());
    }
    Vec2d project(const Vec3d& x) const;  ///< along the line of sight to the plane
};

/// A sphere on the plane z = 0.
struct GlossySphere {
    Vec3d centre = Vec3d::Zero();  ///< world space; z is the radius
    double radius = 0;
};

/// The one with this outline, which a near camera sees off its centre.
GlossySphere sphere_of(const Circle& outline, const PictureFrame& frame);

/// Where on the picture a mirroring sphere shows a lamp.
Vec2d highlight_of(const Light& lamp, const GlossySphere& sphere, const PictureFrame& frame);

/// A lamp, and how sure it is.
struct CalibratedLamp {
    Light light;                           ///< of intensity 1
    Mat3d covariance = Mat3d::Zero();      ///< of light.place
    size_t spheres = 0;                    ///< that show it
    double residual = 0;                   ///< root mean square of its highlights off where they should be, pixels
    double deviation_degrees() const;      ///< of its direction from the origin, standard deviation, the worse way
    double deviation_of_distance() const;  ///< near lamps': of their distance from the origin, as a share of it
};

struct SphereLamps {
    std::vector<uint32_t> images;       ///< those whose lamps the spheres show
    std::vector<CalibratedLamp> lamps;  ///< of these images
    /// Of LampPlace::moved()'s steps of all lamps, three by three: what an outline is off, all lamps are off together.
    Eigen::MatrixXd covariance;
    std::vector<Circle> outlines;  ///< as the highlights agree on them
    bool near = false;             ///< whether lamps are places; directions otherwise
};

/// highlights: [image][sphere]. By least squares over all lamps and outlines together (bundle adjustment), each
/// highlight and outline weighted by its own deviation. Of two spheres or more places, if the median lamp's
/// distance is known to a tenth; directions otherwise. Throws std::invalid_argument without a sphere.
SphereLamps lamps_by_spheres(const std::vector<Circle>& outlines,
                             const std::vector<std::vector<std::optional<Highlight>>>& highlights,
                             const PictureFrame& frame);

}  // namespace radiafit::tools

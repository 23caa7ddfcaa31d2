#pragma once
#include <array>
#include <optional>
#include <span>

#include "geometry/camera.h"

/// Where depths are looked for: a ball around the point that the cameras look at.
namespace radiafit::tools {

struct SearchBall {
    Vec3d centre = Vec3d::Zero();
    double radius = 0;
};

/// centre: the point nearest to all optical axes; radius: `scale` times that of a ball there which fills the shorter
/// side of a photograph, in the median over the cameras; less than the nearest camera's distance. Throws UserError
/// where the axes are parallel.
SearchBall region_of(std::span<const Camera> cameras, double scale);

/// 1/z where the ray through a pixel leaves the ball, and where it enters; none where it misses it. x, y: pixels, 0.5
/// at the centre of the first one.
std::optional<std::array<float, 2>> inverse_depths(const SearchBall& region, const Camera& camera, double x, double y);

}  // namespace radiafit::tools

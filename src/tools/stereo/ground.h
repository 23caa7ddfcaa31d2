#pragma once
#include <optional>
#include <span>
#include <vector>

#include "geometry/camera.h"
#include "geometry/mesh.h"
#include "stereo/region.h"

namespace radiafit::tools {

/// What becomes of the plane that the object stands on.
enum class GroundRule {
    keep,  ///< it stays as it is
    cut,   ///< it is cut off, just above it
    disc   ///< a disc of it stays, a little wider than the object
};

/// normal·x - offset is the height above it.
struct GroundPlane {
    Vec3d normal;  ///< unit, to the cameras' side
    double offset = 0;
    double height(const Vec3d& x) const { return normal.dot(x) - offset; }
};

/// How near to the plane is on it, as a share of the region's radius.
inline constexpr double ground_thickness = 0.01;

/// The plane that the object stands on, where all this holds:
/// - a tenth of the mesh's area or more lies on it, at most 3 % below, and 15 % or more well above;
/// - 95 % of the cameras are above it, and one side of their pictures is in the mean up from it, so that a wall behind
/// an object is
///   none;
/// - the middle of where the cameras look is above it, so that a relief that lies flat has none;
/// - to half of the sides it goes on to near the region's end, so that a plinth, a panel and the floor of a tray are
/// none. Found by drawn triangles (RANSAC, Fischler and Bolles 1981) and least squares.
std::optional<GroundPlane> find_ground(const Mesh& mesh, std::span<const Camera> cameras, const SearchBall& region);

/// What is above it.
Mesh above_ground(const Mesh& mesh, const GroundPlane& ground, const SearchBall& region);
/// What is above or beneath a disc that is a little wider than the object.
Mesh within_disc(const Mesh& mesh, const GroundPlane& ground, const Mesh& object);

}  // namespace radiafit::tools

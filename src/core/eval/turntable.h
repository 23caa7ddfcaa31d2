#pragma once
#include <span>
#include <vector>

#include "dataset/dataset.h"

/// Closed paths of a camera or a lamp around an object, along where those of the training images stood.
namespace radiafit {

struct ClosedPath {
    std::vector<Vec3d> places;  ///< from the centre, in order; after the last comes the first
    double span = 0;            ///< azimuth that it covers, radians; 2 pi: a full circle
    double farthest = 0;        ///< radians: largest angle between the path and the given place nearest to it
};

/// A path of `count` places past `given` ones, which are relative to the centre, around `axis` (unit).
/// Places without a gap of more than `widest_gap` between the next two by azimuth, along their parallel, make a run: if
/// it goes all around, the path is a circle; else it goes along the run with the most places and back, so that it ends
/// where it begins. Height and distance are, at each azimuth, the mean of those of the given places, weighted by a
/// Gaussian of their distance along their parallel; there and back differ by a standard deviation of heights up and
/// down. full_circle: a circle whatever was given. `given` may not be empty, nor hold the centre.
ClosedPath closed_path(std::span<const Vec3d> given, const Vec3d& axis, int count, bool full_circle);
inline constexpr double widest_gap = 1.0471975511965976;  ///< 60 degrees, of direction: near the axis of more azimuth

/// The direction that is up in the pictures of most of the views; a unit vector.
Vec3d up_of(std::span<const View> views);

/// Cameras at centre + places that look at `centre`, of one focal length: the largest at which the mesh lies inside
/// the picture in all of them, with a margin of `frame_margin` of its width and height on either side.
std::vector<Camera> framing_cameras(const Mesh& mesh, const Vec3d& centre, std::span<const Vec3d> places,
                                    const Vec3d& up, int width, int height);
inline constexpr double frame_margin = 0.05;

}  // namespace radiafit

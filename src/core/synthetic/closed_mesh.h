#pragma once
#include "geometry/mesh.h"
#include "synthetic/solid.h"

namespace radiafit {

/// Unit vectors spread evenly over the sphere: a golden spiral with a slight sway, so that no four lie on one circle.
std::vector<Vec3d> sphere_directions(int count);

/// The convex hull of unit vectors in general position: 2 V - 4 triangles, closed, counter-clockwise outward.
std::vector<std::array<uint32_t, 3>> sphere_hull(const std::vector<Vec3d>& directions);

/// A closed mesh of `triangles` well-shaped triangles on the surface of a solid: points spread evenly over
/// the surface, joined by the hull of their directions from `center` (inside the solid), then relaxed: vertices move
/// along the surface, edges flip to Delaunay. `triangles` is even and at least 8.
Mesh wrap_solid(const Solid& solid, const Vec3d& center, int triangles);

/// Each triangle of a closed mesh in n x n equal ones, in its place: the same surface. Triangle t becomes those from t
/// n n on.
Mesh subdivided(const Mesh& mesh, int n);

}  // namespace radiafit

#pragma once
#include <cmath>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "geometry/camera.h"
#include "geometry/mesh.h"
#include "geometry/vertex_rings.h"

/// Meshes that are too large for one fit, cut into parts.
namespace radiafit {

/// Indices of `points` in `count` groups of neighbours, each ascending and of about the same weight: the points in
/// Morton order (Morton 1966, "A computer oriented geodetic data base"), cut into runs. weights: [points], their sum
/// above 0. Depends on nothing but the arguments. Groups may be empty where there are fewer points than groups.
std::vector<std::vector<uint32_t>> groups_of_neighbours(std::span<const Vec3f> points,
                                                        std::span<const uint64_t> weights, size_t count);

/// The mesh of all triangles around `vertices`, which are ascending, and, so many times, of those around their
/// vertices. All vertices but `vertices` are its rim. rings: the whole's.
Mesh part_around(const std::shared_ptr<const Mesh>& whole, const VertexRings& rings, std::span<const uint32_t> vertices,
                 int halo = 0);
/// The mesh of `triangles`, which are ascending; all of its vertices are rim.
Mesh part_of(const std::shared_ptr<const Mesh>& whole, std::vector<uint32_t> triangles);

/// The mesh that images show: the whole where this one is a part.
inline const Mesh& visible_mesh(const Mesh& mesh) { return mesh.surroundings ? *mesh.surroundings->whole : mesh; }
/// A triangle of visible_mesh(), or no_triangle, as one of `mesh`; no_triangle if it is none.
inline uint32_t fitted_triangle(const Mesh& mesh, uint32_t visible) {
    if (!mesh.surroundings || visible == no_triangle) return visible;
    return mesh.surroundings->part_triangle[visible];
}
/// A triangle of `mesh` as one of visible_mesh().
inline uint32_t visible_triangle(const Mesh& mesh, uint32_t triangle) {
    return mesh.surroundings ? mesh.surroundings->triangles[triangle] : triangle;
}

struct Box {
    Vec3f low = Vec3f::Constant(INFINITY), high = Vec3f::Constant(-INFINITY);
};
Box bounding_box(std::span<const Vec3f> points);
/// Whether an image may show something of the box: false only if none of its points can be in it.
bool may_show(const Camera& camera, const Box& box);

}  // namespace radiafit

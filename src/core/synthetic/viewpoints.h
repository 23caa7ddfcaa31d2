#pragma once
#include <cstdint>
#include <vector>

#include "geometry/camera.h"
#include "geometry/mesh.h"

namespace radiafit {

/// `count` cameras spread evenly over the upper hemisphere (z up), swayed and shuffled by the seed, so that any run of
/// consecutive views is spread too. All share one lens; each steps so far back that the mesh fills its frame of
/// side x side pixels.
std::vector<Camera> hemisphere_cameras(const Mesh& mesh, int count, int side, uint64_t seed);
/// The same over the whole sphere.
std::vector<Camera> sphere_cameras(const Mesh& mesh, int count, int side, uint64_t seed);

}  // namespace radiafit

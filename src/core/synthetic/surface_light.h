#pragma once
#include <vector>

#include "geometry/mesh.h"
#include "synthetic/look.h"
#include "synthetic/solid.h"

namespace radiafit {

/// What light does at a point of the surface, whoever looks: the part of the rendering that is the same in all views.
struct PointLight {
    Vec3f normal = Vec3f::UnitZ();        ///< of the solid, unit (interpolated: about unit)
    Vec3f irradiance = Vec3f::Zero();     ///< radiance of a white diffuse surface, lamps and sky, shadows included
    float lamp_visible[lamp_count] = {};  ///< share of each lamp's disc that is seen
    float sky_visible = 0;                ///< share of the sky, weighted by the cosine
};

/// PointLight on a lattice of `side` steps per triangle edge, by shadow rays against the mesh.
class SurfaceLight {
public:
    SurfaceLight(const Mesh& mesh, const Solid& solid, int side);
    PointLight at(uint32_t triangle, float b1, float b2) const;

private:
    size_t lattice_index(int i, int j) const { return size_t(j * (side_ + 1) - j * (j - 1) / 2 + i); }

    int side_;
    size_t points_per_triangle_;
    std::vector<PointLight> points_;
};

}  // namespace radiafit

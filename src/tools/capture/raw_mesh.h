#pragma once
#include <cstddef>
#include <cstdint>
#include <span>

#include "geometry/mesh.h"

namespace radiafit::tools {

/// What a mesh file lists, before welding: every index is within the positions and every position is finite.
struct RawMesh {
    Mesh mesh;
    size_t no_polygons = 0;      ///< points, lines and faces of fewer than three corners, left out
    size_t unused_vertices = 0;  ///< of no face, left out

    /// Triangles around the polygon's first corner.
    void add_polygon(std::span<const uint32_t> corners) {
        if (corners.size() < 3) ++no_polygons;
        for (size_t k = 2; k < corners.size(); ++k) mesh.triangles.push_back({corners[0], corners[k - 1], corners[k]});
    }
};

}  // namespace radiafit::tools

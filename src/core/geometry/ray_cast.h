#pragma once
#include <cstdint>
#include <limits>
#include <vector>

#include "geometry/mesh.h"

namespace radiafit {

/// Where a ray meets the mesh.
struct RayHit {
    double t = std::numeric_limits<double>::infinity();  ///< in lengths of `direction`; infinity where nothing is met
    uint32_t triangle = 0xffffffffu;
    double b1 = 0, b2 = 0;  ///< barycentric weights of the triangle's 2nd and 3rd vertex
    bool hit() const { return triangle != 0xffffffffu; }
};

/// Casts rays at a mesh through a bounding volume hierarchy: the synthetic generators' shadows, and the rasterizer's
/// independent check. Degenerate triangles are never met. Thread-safe after construction.
class RayCaster {
public:
    enum class Faces { both, front };  ///< front: only triangles met against their outward normal

    explicit RayCaster(const Mesh& mesh);  ///< copies what it needs

    /// The nearest hit with t in (0, t_max); `direction` need not be of unit length.
    RayHit closest(const Vec3d& origin, const Vec3d& direction, double t_max = std::numeric_limits<double>::infinity(),
                   Faces faces = Faces::both) const;
    /// Whether anything, front or back, lies at t in (0, t_max). Start a shadow ray a little off its surface.
    bool occluded(const Vec3d& origin, const Vec3d& direction,
                  double t_max = std::numeric_limits<double>::infinity()) const;

private:
    struct Node {
        Vec3f low, high;
        uint32_t first;  ///< of a leaf's triangles; of an inner node: its right child; the left one is the next node
        uint32_t count;  ///< triangles of a leaf, 0 for an inner node
    };
    struct Triangle {
        Vec3d p0, e1, e2;  ///< first vertex and the edges to the others
        uint32_t index;
    };
    struct Builder;

    template <bool any_hit>
    RayHit trace(const Vec3d& origin, const Vec3d& direction, double t_max, Faces faces) const;

    std::vector<Node> nodes_;
    std::vector<Triangle> triangles_;  ///< in leaf order
};

}  // namespace radiafit

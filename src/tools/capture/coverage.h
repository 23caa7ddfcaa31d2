#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "geometry/camera.h"
#include "geometry/mesh.h"

/// Whether a mesh is where the photographs show the object, and if not, where it would be.
namespace radiafit::tools {

/// What one photograph says of where the object is.
struct Silhouette {
    Camera camera;
    std::vector<uint8_t> mask;  ///< [height][width], not 0 = object; empty: unknown
};

/// Counts of pixels, of one photograph or of many.
struct Coverage {
    uint64_t object = 0;  ///< inside the masks; without masks all pixels
    uint64_t both = 0;    ///< those of them whose centre sees the mesh
    uint64_t mesh = 0;    ///< whose centre sees the mesh, inside the masks or not

    double share() const { return object ? double(both) / double(object) : 0; }
    /// What both have over what either has, 1 where mesh and masks agree.
    double overlap() const { return object + mesh > both ? double(both) / double(object + mesh - both) : 0; }
    Coverage& operator+=(const Coverage& other);
};
Coverage measure_coverage(const Mesh& mesh, std::span<const Silhouette> views);

/// The point that the cameras look at: of least summed squared distance to the rays through the masks' centroids, or to
/// the optical axes where there are no masks. None where they are parallel.
std::optional<Vec3d> meeting_point(std::span<const Silhouette> views);

/// Where the mesh would have to be: scale * position + shift, its faces turned over or not.
struct OtherFrame {
    double scale = 1;
    Vec3d shift = Vec3d::Zero();
    bool turned_over = false;
    Coverage coverage;  ///< that it would have there
};

/// Tries the usual mistakes one by one: faces turned inward, another unit (times 100, 1000, 0.01, 0.001), another
/// origin (the mesh's centroid moved to the point that the cameras look at: where the rays through the masks' centroids
/// meet best, without masks the optical axes), both, and of any size (with masks: the one whose outline has the masks'
/// area). The plainest that fits nearly as well as the best; scale 1 without a shift if none fits much better than the
/// mesh as it is. Cost: some fifteen times drawing the mesh in each view.
OtherFrame find_other_frame(const Mesh& mesh, std::span<const Silhouette> views);

/// "scaled by 0.01 it would cover 93 % of the masks: it is in another unit"; empty for the mesh as it is.
std::string describe(const OtherFrame& frame, const std::string& of_what);

}  // namespace radiafit::tools

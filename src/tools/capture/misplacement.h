#pragma once
#include <optional>
#include <span>
#include <string>

#include "base/linear.h"
#include "capture/calibration.h"
#include "capture/mesh_agreement.h"
#include "capture/mesh_placement.h"
#include "capture/small_view.h"
#include "geometry/mesh.h"

/// Finds out why a mesh and photographs do not belong together as they are given, by trying the usual mistakes.
namespace radiafit::tools {

/// A mistake that explains what the photographs show.
struct Misplacement {
    std::string what;      ///< "turned by x,z,-y"; behind it may follow "it would cover ..."
    std::string why;       ///< "it is in other axes"
    std::string cure;      ///< "write T = -R C"; empty: to place the mesh by `move`
    MeshPlacement move;    ///< of the mesh as it was searched
    bool guessed = false;  ///< its shift or scale is what outlines and cameras suggest, not exact
    MeshAgreement given, tried;
    bool masked = false;
    double gain() const { return tried.value(masked) - given.value(masked); }
};

/// Tries, one by one: faces turned inward; translations that are camera centres, poses and camera axes as other
/// formats have them; a transform that the calibration knows; another unit (powers of ten, inches, feet); the 24 turns
/// of axes, and their mirror images; another origin (the mesh's centroid moved to the point that the cameras look at),
/// with other units and of any size (with masks: the size of the masks' area); where none of them fits well, turns with
/// those. The plainest that fits nearly as well as the best, if it fits much better than what is given; else none.
/// `views`: up to 16 are enough. Cost: up to 350 times drawing the mesh in each view; of a mesh that fits passably,
/// what looks promising alone is drawn.
std::optional<Misplacement> find_misplacement(const Mesh& mesh, std::span<const SmallView> views,
                                              const FrameHints& hints);

/// Whether what is given fits so well that a search would find nothing.
bool fits_well(const MeshAgreement& agreement, bool masked);

}  // namespace radiafit::tools

#pragma once
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "capture/mesh_agreement.h"
#include "capture/misplacement.h"
#include "capture/small_view.h"
#include "geometry/mesh.h"

/// Whether the parts of a capture belong together: cameras, photographs, masks and mesh. Judged by what neighbouring
/// photographs show at the same places of the mesh, and by outlines; where they disagree, the usual reasons are tried.
namespace radiafit::tools {

inline constexpr size_t most_checked_views = 256;

struct CaptureCheck {
    std::string summary;                       ///< one line, always
    std::optional<Misplacement> misplacement;  ///< of the mesh, or of all cameras
    bool masks_inverted = false;               ///< what is black in them is where the mesh shows
    std::vector<std::string> notes;            ///< single photographs that do not belong, a line for each reason
    std::vector<std::string> named;            ///< those photographs
};

/// views: in dataset order, no more than most_checked_views.
CaptureCheck check_capture(const Mesh& mesh, std::span<const SmallView> views, const FrameHints& hints = {});

}  // namespace radiafit::tools

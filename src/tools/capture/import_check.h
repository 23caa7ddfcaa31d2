#pragma once
#include <vector>

#include "capture/calibration.h"
#include "capture/capture_check.h"
#include "capture/import.h"
#include "capture/mesh_file.h"
#include "capture/photographs.h"

namespace radiafit::tools {

/// Whether the parts of a capture belong together, as an import has them: refuses a mesh that covers too little of the
/// masks, or of the images where there are none, one that fits far better elsewhere or is closed and inside out, and
/// inverted masks. Says what is wrong with the option that helps, and how well all agrees. placement: of the mesh, by
/// options; views: up to most_checked_views of the photographs.
void check_parts(const std::vector<Photograph>& photographs, const MeshFile& file, const MeshPlacement& placement,
                 const std::vector<SmallView>& views, const ImportOptions& options, const Calibration& model,
                 ImportReport& report);

}  // namespace radiafit::tools

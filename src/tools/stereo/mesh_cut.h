#pragma once
#include <filesystem>
#include <span>

#include "capture/calibration.h"
#include "geometry/mesh.h"
#include "stereo/plane_map.h"
#include "stereo/region.h"

namespace radiafit::tools {

struct CutOptions {
    int support = 2;      ///< photographs whose depth maps have to agree with a vertex
    int close = 6;        ///< rings of triangles by which holes are closed
    double depth = 0.01;  ///< the most by which a depth may differ, as a share of it
    double outside =
        0.2;  ///< the largest share of the masks, of those where a vertex is in the frame, that it is outside
};

/// How many vertices each rule left out.
struct CutReport {
    size_t vertices = 0;     ///< of the mesh as it came
    size_t off_region = 0;   ///< outside the region
    size_t off_masks = 0;    ///< outside the masks
    size_t unsupported = 0;  ///< of the rest: seen where no, or too few, depth maps agree
    size_t apart = 0;        ///< in smaller components
};

/// The part of a mesh that is the object: within the region and the masks, supported by depth maps, its largest
/// connected component by area. Vertices that nothing supports stay where they lie between supported ones, at most
/// `close` rings away. maps: [images], those of the model; masks: of its images, empty where there is none. Throws
/// UserError where nothing is left.
Mesh cut_mesh(const Mesh& mesh, std::span<const PlaneMap> maps, std::span<const std::vector<uint8_t>> masks,
              const SearchBall& region, const CutOptions& options, CutReport& report);

}  // namespace radiafit::tools

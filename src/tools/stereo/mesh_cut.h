#pragma once
#include <filesystem>
#include <span>

#include "capture/calibration.h"
#include "geometry/mesh.h"
#include "stereo/ground.h"
#include "stereo/plane_map.h"
#include "stereo/region.h"

namespace radiafit::tools {

struct CutOptions {
    int support = 2;      ///< photographs whose depth maps have to agree with a vertex; 0: depths cut nothing
    int close = 12;       ///< rings of triangles from the middle of a hole to its edge, up to which it is filled
    double depth = 0.01;  ///< the most by which a depth may differ, as a share of it
    double outside =
        0.2;  ///< the largest share of the masks, of those where a vertex is in the frame, that it is outside
    GroundRule ground = GroundRule::cut;  ///< what becomes of the plane that the object stands on
};

/// How many vertices each rule left out, in this order.
struct CutReport {
    size_t vertices = 0;       ///< of the mesh as it came
    size_t off_region = 0;     ///< outside the region
    size_t off_masks = 0;      ///< outside the masks
    size_t in_free_space = 0;  ///< where photographs see past them (stereo/vertex_evidence.h)
    size_t unsupported = 0;    ///< of the rest: seen where no, or too few, depth maps agree
    size_t apart = 0;          ///< in smaller pieces; of what stood on the ground, below 2 % of the largest one's area
    bool ground = false;       ///< a plane that the object stands on was found, and the rule carried out
};

/// The part of a mesh that is the object: within the region and the masks, supported by depth maps, its largest piece
/// by area (of what stands on a ground that is cut off, all but debris), with the ground as the options say, and its
/// border smoothed (stereo/mesh_border.h). Vertices that nothing supports stay where supported ones enclose them,
/// `close` rings away at most, and in notches of two rings, unless photographs see past them. maps: [images], those of
/// the model; masks: of its images, empty where there is none. Throws UserError where nothing is
/// left, and for a mesh inside out.
Mesh cut_mesh(const Mesh& mesh, std::span<const PlaneMap> maps, std::span<const std::vector<uint8_t>> masks,
              const SearchBall& region, const CutOptions& options, CutReport& report);

}  // namespace radiafit::tools

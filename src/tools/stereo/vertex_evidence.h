#pragma once
#include <span>
#include <vector>

#include "geometry/mesh.h"
#include "stereo/plane_map.h"

namespace radiafit::tools {

/// In how many photographs a mesh's vertices are what depth maps and masks say. Lists are [mesh.vertex_count()].
struct VertexEvidence {
    std::vector<uint32_t> framed;      ///< it lies in the picture
    std::vector<uint32_t> masked_out;  ///< of those, outside the mask
    std::vector<uint32_t> supported;   ///< it is in front, and the depth there is its own
    std::vector<uint32_t> seen_past;   ///< the photograph sees what lies behind it: there is nothing in front of that
    /// Where a vertex has a photograph's depth, hidden or not, over all photographs: how often the mesh faces the
    /// camera there, and how often it turns its back on it.
    size_t facing = 0, averted = 0;

    /// Photographs show the back of nearly all of the mesh. (Both sides of what is thin have the same depths.)
    bool inside_out() const { return averted > 3 * facing; }
    /// Photographs see past it: two or more, and more than those that support it.
    bool in_free_space(size_t vertex) const { return seen_past[vertex] >= 2 && seen_past[vertex] > supported[vertex]; }
};

inline constexpr const char* inside_out_text =
    "the photographs show the back of the mesh: the corners of its triangles must go counterclockwise, seen from "
    "outside; flip its faces in a mesh editor";

/// maps: [photographs]; masks: of the same, empty where there is none. tolerance: of depths, as a share of them. Seen
/// past is a vertex where all depths within two pixels are beyond it by more than the tolerance.
VertexEvidence evidence_of(const Mesh& mesh, std::span<const PlaneMap> maps,
                           std::span<const std::vector<uint8_t>> masks, double tolerance);

}  // namespace radiafit::tools

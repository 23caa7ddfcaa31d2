#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

/// Whether a mesh is where the photographs show the object.
namespace radiafit::tools {

struct MeshCheck {
    size_t vertices = 0, triangles = 0;
    size_t points = 0;    ///< of the calibration that are seen amid the mesh, counted once per photograph
    double distance = 0;  ///< median distance of such a point from the mesh, as a share of its bounding box's diagonal
    double near_share = 0;  ///< of such points, within 1 % of the diagonal
    struct Photograph {
        std::string name;
        double share = 0;    ///< of its pixels that show the mesh
        double overlap = 0;  ///< with its mask: common pixels over all of both; 0 without masks
    };
    std::vector<Photograph> photographs;
    size_t pieces = 0;         ///< that triangles connect
    size_t borders = 0;        ///< lines of edges that have one triangle alone
    double border_length = 0;  ///< of all, as a share of the diagonal
    /// By the depths of photographs (stereo/vertex_evidence.h), shares of the area.
    struct Surface {
        double supported = 0;      ///< two photographs or more have it where it is
        double in_free_space = 0;  ///< photographs see past it: flaps and debris
        double unknown = 0;        ///< the rest
        bool inside_out = false;   ///< photographs show its back
    };
    std::optional<Surface> surface;
    double share = 0;               ///< median over photographs
    double overlap = 0;             ///< median over photographs; 0 without masks
    std::vector<std::string> poor;  ///< see ModelCheck::poor
};

/// What a mesh is held against.
struct MeshCheckInput {
    std::filesystem::path mesh, model;    ///< model: as of check_model()
    std::filesystem::path depths;         ///< what compute_depths() wrote; empty: none
    std::filesystem::path images, masks;  ///< masks (capture/mask_names.h) for photographs in `images`; empty: none
};

/// Poor are: a median distance above 0.5 % of the diagonal, a mesh that covers less than 3 % of the photographs, an
/// overlap with the masks below 0.7, medians all; more than 2 % of the area in free space; and a mesh inside out.
/// Throws UserError.
MeshCheck check_mesh(const MeshCheckInput& input);

}  // namespace radiafit::tools

#pragma once
#include <filesystem>
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
    double share = 0;               ///< median over photographs
    double overlap = 0;             ///< median over photographs; 0 without masks
    std::vector<std::string> poor;  ///< see ModelCheck::poor
};

/// model: as of check_model(). masks: a folder (capture/mask_names.h) for the photographs in the folder `images`;
/// empty: none. Poor are: a median distance above 0.5 % of the diagonal, a mesh that covers less than 3 % of the
/// photographs, or an overlap with the masks below 0.7, medians all. Throws UserError.
MeshCheck check_mesh(const std::filesystem::path& mesh, const std::filesystem::path& model,
                     const std::filesystem::path& images, const std::filesystem::path& masks);

}  // namespace radiafit::tools

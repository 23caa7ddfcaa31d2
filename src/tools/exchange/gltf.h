#pragma once
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "exchange/surface_look.h"

/// glTF 2.0 in one file (GLB): the surface with base colour and roughness, and the fit's files.
namespace radiafit::tools {

/// One of the fit's files, as it is in its folder.
struct OwnFile {
    std::string name, bytes;
};

/// Triangles have three separate vertices each, since each has a separate place in the textures; a grid is a
/// rectangle. What was up in the photographs is up (+y). A model without a lobe whose light stayed is to be shown
/// unlit (KHR_materials_unlit). Vertices are those of the dataset; the look's atlas and the dataset must outlive the
/// call. Throws UserError for more bytes than the format has (4 GiB).
///
/// `extras` of the file's root says under "radiafit" what model it is, what base colour and roughness mean, and which
/// buffer view is which of `own`; texture coordinates 1 are those of the fit's maps.
std::string glb_of(const SurfaceLook& look, const Dataset& dataset, const std::string& model,
                   const std::vector<OwnFile>& own);

/// Whether the file at `path` is one that glb_of() made.
bool is_our_glb(const std::filesystem::path& path);

}  // namespace radiafit::tools

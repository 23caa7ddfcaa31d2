#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace radiafit::tools {

/// The masks of photographs, found by how they are named.
struct MaskNames {
    std::vector<std::filesystem::path> files;  ///< one per photograph
    std::string remark;                        ///< by which habit, with an example
    std::vector<std::string> notes;            ///< masks by other habits that were left aside, one line each
};

/// Of a photograph NAME.EXT the mask is NAME.png, NAME.EXT.png, NAME_mask.png, NAME.mask.png, NAME.EXT.mask.png or
/// mask_NAME.png, in the subfolder of `masks` that the photograph has in `images`, or in `masks` itself; endings in any
/// letter case, other formats of photographs where there is no PNG. The habit that most photographs' masks follow is
/// taken for all, among equals the first. A photograph is never its own mask.
/// names: relative to `images`, one at least. Throws UserError that names the photographs whose masks are missing,
/// are found twice, or would be another's, too.
MaskNames match_masks(const std::filesystem::path& masks, const std::filesystem::path& images,
                      const std::vector<std::string>& names);

}  // namespace radiafit::tools

#pragma once
#include <filesystem>
#include <vector>

#include "base/linear.h"
#include "image/image_file.h"

namespace radiafit::tools {

struct NormalFile {
    int width = 0, height = 0;
    std::vector<Vec3f> normals;  ///< [height][width], row 0 on top: unit, or 0 where the file has none
};

/// A picture of normals, x right, y up, z towards the camera in red, green and blue: floats hold them as they are (PFM,
/// EXR), 8 and 16 bits as (n + 1) / 2. Lengths are set to 1; what is nearer to 0 than 0.5 or beyond 1.5 is none.
/// Throws UserError that names file and cure: unreadable, a number that is not finite.
NormalFile read_normal_file(const std::filesystem::path& file, const HeaderCheck& check = {});

}  // namespace radiafit::tools

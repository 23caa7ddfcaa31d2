#include "stereo/output_names.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.h"

namespace radiafit::tools {

std::filesystem::path output_name(const std::string& image) {
    const std::filesystem::path name(image);
    if (name.has_root_path() || std::find(name.begin(), name.end(), "..") != name.end())
        throw UserError(fmt::format("image '{}': its name leads out of the output folder: rename it", image));
    return name;
}

}  // namespace radiafit::tools

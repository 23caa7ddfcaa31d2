#pragma once
#include <filesystem>
#include <string_view>

namespace radiafit {

/// A kind of files that people give as pictures, and that is not read.
struct OtherKind {
    const char* name;  ///< with its article
    const char* cure;  ///< the command that converts it
};

/// The kind that the file's first bytes tell, or null.
const OtherKind* find_other_kind(std::string_view bytes);

/// Whether the name ends as a camera's raw files do. Many of them are TIFFs whose first picture is a small preview.
bool is_raw_name(const std::filesystem::path& file);

inline constexpr const char* raw_cure = "develop it to 16-bit TIFF (darktable-cli FILE.raw FILE.tif, or dcraw -T -6)";

}  // namespace radiafit

#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// What a PLY file says about itself, before its numbers.
namespace radiafit::tools {

struct PlyType {
    int bytes;  ///< in binary files
    enum class Kind { whole, natural, real } kind;
};

struct PlyProperty {
    std::string name;
    PlyType type;                   ///< of the value, or of a list's items
    std::optional<PlyType> length;  ///< of a list: the type of its number of items
};

struct PlyElement {
    std::string name;
    uint64_t count;
    std::vector<PlyProperty> properties;
};

struct PlyHeader {
    enum class Format { ascii, little_endian, big_endian } format;
    std::vector<PlyElement> elements;
    size_t bytes = 0, lines = 0;  ///< of the header itself
};

/// Whether a file's content begins as a PLY file does.
bool is_ply(std::string_view content);

/// Throws UserError that names file, line and cure: malformed, an element or a property given twice, an element without
/// properties, and counts that the bytes after the header cannot hold.
PlyHeader read_ply_header(const std::filesystem::path& file, std::string_view content);

}  // namespace radiafit::tools

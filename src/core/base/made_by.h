#pragma once
#include <filesystem>
#include <optional>
#include <string>

/// Which command made an output, of what: by it the same command again says that it is done, and another one replaces
/// nothing unasked (output_claims.h). A folder says so in a hidden file, a file by a word that stands where its format
/// has room for a remark (docs/formats.md).
namespace radiafit {

struct MadeBy {
    std::string command;  ///< its words: "import colmap"
    std::string key;      ///< 16 hexadecimal digits over all that decides what it writes, its input included
    bool operator==(const MadeBy&) const = default;
};

/// In every folder that a command made.
inline constexpr const char* made_by_name = ".radiafit-made.json";

/// "radiafit_made_by_import_colmap_0123456789abcdef".
std::string made_by_word(const MadeBy& made);

/// Writes made_by_name into a folder that holds all else, in which names and sizes of its files stand, too. Throws as
/// AtomicFile does.
void write_made_by(const std::filesystem::path& folder, const MadeBy& made);

/// Of a folder what its made_by_name says, of a file the word in its first megabytes or at its end. None where nothing
/// is said, or is there.
std::optional<MadeBy> made_by(const std::filesystem::path& output);

/// Whether the folder's made_by_name lists the file.
bool is_listed(const std::filesystem::path& folder, const std::filesystem::path& name);

/// Whether a folder still holds every file that its made_by_name lists, of the same size.
bool as_it_was_made(const std::filesystem::path& folder);

}  // namespace radiafit

#pragma once
#include <filesystem>
#include <string>

namespace radiafit {

/// The bytes of a file that the user named; `what` is its role, such as "gain table". Waits on no pipe or device.
/// Throws UserError: missing, unreadable, no regular file, larger than 4 GiB (a file may say more than the disk holds).
std::string read_file(const std::filesystem::path& file, const std::string& what);

/// Throws the UserError of read_file() for a file that is missing, unreadable, not regular or larger than 4 GiB.
void check_readable(const std::filesystem::path& file, const std::string& what);

/// Whether something, or a folder, exists at a path or where its links lead. Throw UserError where that can't be known:
/// no permission to look into its folder, links in a circle.
bool path_exists(const std::filesystem::path& path);
bool folder_exists(const std::filesystem::path& path);

}  // namespace radiafit

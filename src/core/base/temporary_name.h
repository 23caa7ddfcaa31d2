#pragma once
#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

/// Hidden names of files and folders that are not whole yet: PREFIX-PROCESS-NUMBER-NAME beside NAME. Numbers
/// count from the time (ms) at which the process made its first.
namespace radiafit {

inline constexpr std::string_view unfinished_prefix = ".radiafit-tmp";  ///< on its way to NAME
inline constexpr std::string_view replaced_prefix = ".radiafit-old";    ///< was at NAME until a moment ago

/// A new name in `folder`.
std::filesystem::path temporary_name(const std::filesystem::path& folder, const std::string& name,
                                     std::string_view prefix = unfinished_prefix);

struct TemporaryName {
    pid_t process = 0;  ///< 0: the name is none of ours
    uint64_t number = 0;
    std::string name;

    /// An earlier process may have had this one's number, as the first of a container always has.
    bool made_by_this_process() const;
};
/// Takes a file name apart.
TemporaryName parse_temporary_name(std::string_view file_name, std::string_view prefix);

/// The path without what is temporary in it: what its user knows it by.
std::filesystem::path final_path(const std::filesystem::path& path);
/// Whether it lies in a folder that has no name yet.
bool within_unfinished_folder(const std::filesystem::path& path);

}  // namespace radiafit

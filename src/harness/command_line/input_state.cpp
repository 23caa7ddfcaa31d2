#include "command_line/input_state.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <string_view>
#include <system_error>
#include <vector>

#include "base/hash.h"
#include "base/made_by.h"

namespace radiafit::harness {
namespace {

namespace fs = std::filesystem;

constexpr uintmax_t most_bytes_read = 32 << 20;

std::string digest(const std::string& bytes) { return fmt::format("{:016x}", hash_bytes(bytes.data(), bytes.size())); }

std::string bytes_of(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(stream), {});
}

struct InputFile {
    std::string name;  ///< below the input
    fs::path path;
    uintmax_t bytes = 0;
};

/// Pipes and devices have no bytes, and nothing reads them here.
InputFile input_file(const fs::path& path, const std::string& name) {
    std::error_code error;
    const uintmax_t bytes = fs::is_regular_file(path, error) ? fs::file_size(path, error) : 0;
    return {name, path, error ? 0 : bytes};
}

std::vector<InputFile> files_below(const fs::path& folder) {
    std::vector<InputFile> files;
    std::error_code error;
    for (fs::recursive_directory_iterator at(folder, fs::directory_options::skip_permission_denied, error), end;
         !error && at != end; at.increment(error)) {
        std::error_code ignored;
        const bool hidden = at->path().filename().string().starts_with(".");
        if (at->is_directory(ignored)) {
            if (hidden || fs::exists(at->path() / made_by_name, ignored)) at.disable_recursion_pending();
        } else if (!hidden) {
            files.push_back(input_file(at->path(), at->path().lexically_relative(folder).string()));
        }
    }
    std::ranges::sort(files, {}, &InputFile::name);
    return files;
}

std::string state_of(const std::vector<InputFile>& files) {
    uintmax_t bytes = 0;
    for (const InputFile& file : files) bytes += file.bytes;
    std::string all;
    for (const InputFile& file : files) {
        std::error_code error;
        const auto changed = fs::last_write_time(file.path, error).time_since_epoch().count();
        const bool read = bytes <= most_bytes_read && fs::is_regular_file(file.path, error);
        all += fmt::format("{} {} {}\n", file.name, file.bytes,
                           read ? digest(bytes_of(file.path)) : std::to_string(changed));
    }
    return digest(all);
}

}  // namespace

std::string input_state(const fs::path& input) {
    std::error_code error;
    const fs::file_status status = fs::status(input, error);
    if (!fs::exists(status)) return input.string();
    if (!fs::is_directory(status)) return state_of({input_file(input, "")});
    for (const char* name : {"dataset.json", "fit.json"})
        if (fs::is_regular_file(input / name, error)) {
            const std::string description = bytes_of(input / name);
            // Datasets of older versions have no checksums of their images.
            const bool all =
                std::string_view(name) == "fit.json" || description.find("\"checksum\"") != std::string::npos;
            return digest(description) + (all ? "" : state_of(files_below(input)));
        }
    return state_of(files_below(input));
}

}  // namespace radiafit::harness

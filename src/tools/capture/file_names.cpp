#include "capture/file_names.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "base/error.h"
#include "image/image_format.h"

namespace radiafit::tools {

std::string lower_case(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
    return text;
}

std::string lower_ending(const std::filesystem::path& file) { return lower_case(file.extension().string()); }

bool is_hidden(const std::filesystem::path& file) { return file.filename().string().starts_with('.'); }

std::string dataset_name(const std::string& chosen, const std::filesystem::path& folder) {
    return chosen.empty() ? (folder / ".").lexically_normal().parent_path().filename().string() : chosen;
}

std::vector<std::string> list_images(const std::filesystem::path& folder) {
    std::vector<std::string> names;
    std::error_code error;
    std::filesystem::directory_iterator entries(folder, error);
    for (; !error && entries != std::filesystem::directory_iterator(); entries.increment(error)) {
        const std::filesystem::directory_entry& entry = *entries;
        std::error_code ignored;
        if (entry.is_regular_file(ignored) && !is_hidden(entry.path()) && format_of_name(entry.path()))
            names.push_back(entry.path().filename().string());
    }
    if (error)
        throw UserError(
            fmt::format("{}: cannot list this folder: {}: check its permissions", folder.string(), error.message()));
    std::sort(names.begin(), names.end());
    return names;
}

}  // namespace radiafit::tools

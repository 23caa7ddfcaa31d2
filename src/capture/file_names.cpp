#include "capture/file_names.h"

#include <algorithm>
#include <cctype>

namespace radiafit {

std::string lower_ending(const std::filesystem::path& file) {
    std::string ending = file.extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return std::tolower(c); });
    return ending;
}

std::string dataset_name(const std::string& chosen, const std::filesystem::path& folder) {
    return chosen.empty() ? (folder / ".").lexically_normal().parent_path().filename().string() : chosen;
}

}  // namespace radiafit

#include "fit/folder_parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "base/error.h"
#include "base/leftovers.h"
#include "base/made_by.h"
#include "base/read_file.h"
#include "base/wording.h"

namespace radiafit {
namespace fs = std::filesystem;

std::string read_text(const fs::path& path) {
    std::error_code ignored;
    if (fs::symlink_status(path, ignored).type() == fs::file_type::not_found)
        throw UserError(fmt::format("{}: no such file; {}", path.string(),
                                    at_command_line("give a folder that radiafit fit wrote", "give a fit's folder")));
    return read_file(path, "fit's description");
}

std::vector<std::string> names_in(const fs::path& folder) {
    std::vector<std::string> names;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder))
        if (entry.path().filename() != made_by_name) names.push_back(entry.path().filename().string());
    std::sort(names.begin(), names.end());
    return names;
}

void require(bool holds, const std::string& what) {
    if (!holds) throw std::invalid_argument("write_fit: " + what);
}

void require_problems(const FitRecord& fit, size_t problems) {
    require(fit.status.size() == problems && fit.iterations.size() == problems && fit.samples.size() == problems &&
                fit.error.size() == problems,
            "status, iterations, samples and error per problem");
    for (const uint32_t samples : fit.samples) require(samples <= 1u << 24, "samples per problem up to 2^24");
}

void require_folder(const fs::path& folder) {
    restore_interrupted(folder);
    if (!folder_exists(folder))
        throw UserError(fmt::format("{}: no such folder; {}", folder.string(),
                                    at_command_line("radiafit fit writes one", "give a fit's folder")));
}

void check_promises(const FitRecord& fit, const FitPromises& promises, const fs::path& problems) {
    if (fit.status_counts() != promises.status_counts)
        throw UserError(
            fmt::format("{}: its statuses disagree with those counted in fit.json; restore the file or fit again",
                        problems.string()));
}

std::string dataset_from(const fs::path& folder, const FitRecord& fit) {
    std::error_code error;
    fs::path dataset = fs::relative(fit.dataset_path, fs::absolute(folder), error);
    if (error || dataset.empty()) dataset = fs::absolute(fit.dataset_path);
    return dataset.generic_string();
}

}  // namespace radiafit

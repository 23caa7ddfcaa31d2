#include "fitting/unfinished.h"

#include <fmt/format.h>

#include <system_error>
#include <vector>

#include "base/error.h"
#include "base/journal.h"
#include "base/leftovers.h"
#include "base/log.h"
#include "base/read_file.h"
#include "fitting/fit_key.h"
#include "fitting/parts/part_result.h"
#include "fitting/parts/parts.h"

namespace radiafit::fits {
namespace {

namespace fs = std::filesystem;

bool is_journal(const fs::path& file) { return file.extension() == journal_extension; }

/// Parts and journals.
std::vector<fs::path> files_in(const fs::path& folder) {
    std::vector<fs::path> out;
    if (!folder_exists(folder)) return out;
    for (const auto& entry : fs::directory_iterator(folder))
        if (entry.is_regular_file() &&
            (is_journal(entry.path()) || entry.path().filename().string().starts_with("part-")))
            out.push_back(entry.path());
    return out;
}

}  // namespace

fs::path unfinished_folder(const fs::path& out) {
    return fs::path(out.has_filename() ? out : out.parent_path()).concat(".parts");
}

bool anything_unfinished(const fs::path& folder) { return !files_in(folder).empty(); }

std::string what_is_unfinished(const fs::path& folder) {
    if (!anything_unfinished(folder)) return "nothing was finished: the same command begins anew";
    return fmt::format("{} keeps what is finished; the same command with --resume goes on from there", folder.string());
}

std::string why_not_resumable(const fs::path& folder, const std::string& key) {
    for (const fs::path& file : files_in(folder)) {
        const std::string there = is_journal(file) ? Journal::key_of(file) : part_key(file);
        if (const std::string difference = difference_of_keys(there, key); !difference.empty())
            return fmt::format("holds parts of another fit: {}", difference);
    }
    return "";
}

void check_unfinished(const fs::path& folder, const std::string& key, bool resume) {
    if (!anything_unfinished(folder)) {
        if (resume) log_info(fmt::format("{}: nothing there to go on from; the fit begins", folder.string()));
        return;
    }
    const std::string why = why_not_resumable(folder, key);
    if (why.empty()) return log_info(fmt::format("{}: goes on from there", folder.string()));
    if (resume)
        throw UserError(fmt::format("{}: {}; give the command that was stopped, or leave out --resume to begin anew",
                                    folder.string(), why));
    log_info(fmt::format("{}: {}; removed, and the fit begins anew", folder.string(), why));
    remove_unfinished(folder);
}

void remove_leftovers_of(const fs::path& out) {
    std::error_code error;
    const fs::path folder = unfinished_folder(out), target = follow_links(out);
    const fs::file_time_type ended = fs::last_write_time(target, error);
    if (error) return;
    clear_leftovers(target.parent_path());
    if (!folder_exists(folder)) return;
    for (const auto& entry : fs::recursive_directory_iterator(folder))
        if (fs::last_write_time(entry.path(), error) > ended || error) return;
    remove_unfinished(folder);
}

void remove_unfinished(const fs::path& folder) {
    std::error_code ignored;
    for (const fs::path& file : files_in(folder)) fs::remove(file, ignored);
    if (!folder_exists(folder)) return;
    fs::remove(folder / shard_json_name, ignored);
    for (const auto& entry : fs::directory_iterator(folder))  // of ranks
        if (entry.path().filename().string().starts_with("shard-") && entry.is_directory())
            remove_unfinished(entry.path());
    fs::remove(folder, ignored);
}

}  // namespace radiafit::fits

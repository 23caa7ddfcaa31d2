#include "app/unfinished.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <system_error>
#include <vector>

#include "app/fit_key.h"
#include "app/part_result.h"
#include "app/parts.h"
#include "base/error.h"
#include "base/journal.h"
#include "base/log.h"
#include "base/read_file.h"

namespace radiafit {
namespace {

namespace fs = std::filesystem;

bool is_journal(const fs::path& file) { return file.extension() == journal_extension; }
bool is_part(const fs::path& file) {
    return file.filename().string().starts_with("part-") && file.extension() == ".bin";
}

/// Parts and journals, sorted.
std::vector<fs::path> files_in(const fs::path& folder) {
    std::vector<fs::path> out;
    if (!folder_stands(folder)) return out;
    for (const auto& entry : fs::directory_iterator(folder))
        if (entry.is_regular_file() && (is_journal(entry.path()) || is_part(entry.path()))) out.push_back(entry.path());
    std::ranges::sort(out);
    return out;
}

/// As a shell takes it.
std::string quoted(const std::string& word) {
    const bool plain = !word.empty() && word.find_first_not_of(
                                            "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                            "0123456789_./:=,+-%@") == std::string::npos;
    if (plain) return word;
    std::string out = "'";
    for (const char c : word) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return out + "'";
}

}  // namespace

fs::path unfinished_folder(const fs::path& out) {
    const fs::path named = out.has_filename() ? out : out.parent_path();
    return fs::path(named).concat(".parts");
}

std::string why_not_resumable(const fs::path& folder, const std::string& key) {
    for (const fs::path& file : files_in(folder)) {
        const auto there = is_journal(file) ? Journal::key_of(file) : part_key(file);
        if (!there) return fmt::format("{} is damaged", file.filename().string());
        if (const std::string difference = difference_of_keys(*there, key); !difference.empty())
            return fmt::format("holds parts of another fit: {}", difference);
    }
    return "";
}

void settle_unfinished(const fs::path& folder, const std::string& key, bool resume) {
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

bool anything_unfinished(const fs::path& folder) { return !files_in(folder).empty(); }

std::string how_to_go_on(const fs::path& folder, int argc, const char* const* argv) {
    if (!anything_unfinished(folder)) return "nothing was finished: the same command begins anew";
    std::string command;
    bool resumes = false;
    for (int i = 0; i < argc; ++i) {
        command += quoted(argv[i]) + " ";
        resumes = resumes || argv[i] == std::string("--resume");
    }
    return fmt::format("what is finished is kept in {}; to go on: {}{}", folder.string(), command,
                       resumes ? "" : "--resume");
}

void remove_unfinished(const fs::path& folder) {
    std::error_code ignored;
    for (const fs::path& file : files_in(folder)) fs::remove(file, ignored);
    if (!folder_stands(folder)) return;
    fs::remove(folder / shard_json_name, ignored);
    for (const auto& entry : fs::directory_iterator(folder))  // of ranks
        if (entry.path().filename().string().starts_with("shard-") && entry.is_directory())
            remove_unfinished(entry.path());
    fs::remove(folder, ignored);
}

}  // namespace radiafit

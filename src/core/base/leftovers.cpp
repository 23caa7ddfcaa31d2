#include "base/leftovers.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <system_error>
#include <vector>

#include "base/error.h"
#include "base/temporary_name.h"

namespace radiafit {
namespace fs = std::filesystem;
namespace {

bool path_exists(const fs::path& path) {
    std::error_code error;
    return fs::exists(fs::symlink_status(path, error));
}

/// Whether no other process of that number runs here: one that runs may not have locked its file yet. Whether a process
/// elsewhere (another container, say) is still at work, only the lock shows.
bool may_be_left(const TemporaryName& name) {
    if (name.process == 0 || name.made_by_this_process()) return false;
    return name.process == getpid() || (kill(name.process, 0) != 0 && errno == ESRCH);
}

struct Leftover {
    fs::path path;
    fs::path target;  ///< whose place a replaced one gave up; empty for an unfinished one
};

std::vector<Leftover> leftovers_in(const fs::path& folder) {
    std::vector<Leftover> found;
    std::error_code error;
    for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
        const std::string name = at->path().filename().string();
        if (const auto unfinished = parse_temporary_name(name, unfinished_prefix); may_be_left(unfinished))
            found.push_back({at->path(), {}});
        if (const auto replaced = parse_temporary_name(name, replaced_prefix); may_be_left(replaced))
            found.push_back({at->path(), folder / replaced.name});
    }
    return found;
}

fs::path folder_of(const fs::path& path) { return path.has_parent_path() ? path.parent_path() : fs::path("."); }

void restore(const Leftover& leftover) {
    const int lock = lock_path(leftover.path);
    if (lock < 0) return;
    std::error_code ignored;
    fs::rename(leftover.path, leftover.target, ignored);
    close(lock);
}

}  // namespace

int lock_path(const fs::path& path) {
    const int file = open(path.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
    if (file >= 0 && flock(file, LOCK_EX | LOCK_NB) == 0) return file;
    if (file >= 0) close(file);
    return -1;
}

fs::path follow_links(fs::path path) {
    if (!path.has_filename()) path = path.parent_path();
    std::error_code error;
    const fs::path named = path;
    for (int links = 0; fs::is_symlink(path, error); ++links) {
        if (links == 40)
            throw UserError(
                fmt::format("{}: its links lead in a circle; remove them or choose another name", named.string()));
        const fs::path next = fs::read_symlink(path, error);
        if (error) break;
        path = path.parent_path() / next;  // an absolute one replaces the parent
        if (!path.has_filename()) path = path.parent_path();
    }
    return path;
}

void clear_leftovers(const fs::path& folder) {
    for (const Leftover& leftover : leftovers_in(folder.empty() ? fs::path(".") : folder)) {
        if (!leftover.target.empty() && !path_exists(leftover.target)) {
            restore(leftover);
            continue;
        }
        const int lock = lock_path(leftover.path);
        if (lock < 0) continue;
        std::error_code ignored;
        fs::remove_all(leftover.path, ignored);
        close(lock);
    }
}

void restore_interrupted(const fs::path& folder) {
    const fs::path target = follow_links(folder);
    if (path_exists(target)) return;
    for (const Leftover& leftover : leftovers_in(folder_of(target)))
        if (leftover.target.filename() == target.filename() && !path_exists(target)) restore(leftover);
}

}  // namespace radiafit

#include "base/atomic_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <string>
#include <system_error>
#include <utility>

#include "base/error.h"
#include "base/leftovers.h"
#include "base/made_by.h"
#include "base/output_claims.h"
#include "base/temporary_name.h"

namespace radiafit {
namespace fs = std::filesystem;
namespace {

[[noreturn]] void refuse_name(const fs::path& path, const std::string& why) {
    throw UserError(
        fmt::format("cannot write {}: {}; choose another name", path.empty() ? "\"\"" : path.string(), why));
}

fs::path or_here(const fs::path& folder) { return folder.empty() ? fs::path(".") : folder; }

/// 0 or errno.
int rename_with(const fs::path& from, const fs::path& to, unsigned flags) {
    return renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), flags) == 0 ? 0 : errno;
}
int plain_rename(const fs::path& from, const fs::path& to) {
    return std::rename(from.c_str(), to.c_str()) == 0 ? 0 : errno;
}

bool unsupported(int error) { return error == EINVAL || error == ENOSYS || error == EOPNOTSUPP; }

/// Renames in one step; what was at `to` is then at `from`. `check` may refuse to replace it. Returns 0 or errno.
template <class Check>
int rename_or_exchange(const fs::path& from, const fs::path& to, Check check) {
    while (true) {
        int error = rename_with(from, to, RENAME_NOREPLACE);
        if (error != EEXIST) return error;
        check();
        error = rename_with(from, to, RENAME_EXCHANGE);
        if (error != ENOENT) return error;  // else it went meanwhile
    }
}

/// Undoes rename_or_exchange(from, to).
void take_back(const fs::path& to, const fs::path& from) {
    std::error_code ignored;
    const bool replaced = fs::exists(fs::symlink_status(from, ignored));
    rename_with(to, from, replaced ? RENAME_EXCHANGE : RENAME_NOREPLACE);
}

void remove_quietly(const fs::path& path) {
    std::error_code ignored;
    fs::remove_all(path, ignored);
}

/// Whether another file system begins there, so that nothing can be renamed to it.
bool is_mount_point(const fs::path& path) {
    struct stat here, above;
    return lstat(path.c_str(), &here) == 0 && S_ISDIR(here.st_mode) &&
           stat(or_here(path.parent_path()).c_str(), &above) == 0 && here.st_dev != above.st_dev;
}

fs::path folder_name(fs::path target) {
    target = follow_links(target);  // links stay, and what they lead to is replaced
    if (target.empty()) refuse_name(target, "it has no name");
    if (!target.has_filename() || target.filename() == "." || target.filename() == "..")
        refuse_name(target, "it is no name of a new folder");
    if (is_mount_point(target)) refuse_name(target, "another disk begins there");
    return target;
}

fs::path file_name(fs::path path) {
    if (!path.has_filename()) refuse_name(path, path.empty() ? "it has no name" : "it names a folder");
    std::error_code error;
    if (fs::is_directory(path, error)) refuse_name(path, "it is a folder");
    return path;
}

/// A name beside the file, whose folder is cleared of what others left.
fs::path temporary_file_of(const fs::path& path) {
    if (!within_unfinished_folder(path)) clear_leftovers(path.parent_path());
    return temporary_name(path.parent_path(), path.filename().string());
}

}  // namespace

AtomicFile::AtomicFile(fs::path path)
    : path_(file_name(std::move(path))), temporary_(temporary_file_of(path_)), out_(temporary_) {
    out_.lock();
}

AtomicFile::~AtomicFile() {
    if (!committed_) remove_quietly(temporary_);
}

void AtomicFile::commit() {
    const bool durable = !within_unfinished_folder(path_);
    out_.close();
    if (durable) sync_to_disk(temporary_);
    if (const int error = plain_rename(temporary_, path_)) throw_unwritable(path_, error);
    committed_ = true;
    if (durable) sync_to_disk(or_here(path_.parent_path()));
}

void write_file(const fs::path& path, std::string_view bytes) {
    AtomicFile file(path);
    file.write(bytes);
    file.commit();
}

UnfinishedFolder::UnfinishedFolder(const fs::path& parent, const std::string& name)
    : path_(temporary_name(parent, name)) {
    clear_leftovers(parent);
    make();
    lock_ = lock_path(path_);
}

/// Tries again if a parent vanished meanwhile: another process that had made it may have had no use for it.
void UnfinishedFolder::make() {
    std::error_code error;
    for (int tries = 0; tries < 100; ++tries) {
        make_parents(error);
        if (!error) fs::create_directory(path_, error);
        if (error != std::errc::no_such_file_or_directory) break;
    }
    if (!error) return;
    remove_made_parents();
    throw_unwritable(path_, error.value());
}

void UnfinishedFolder::make_parents(std::error_code& error) {
    std::vector<fs::path> missing;
    for (fs::path at = path_.parent_path(); !at.empty() && !fs::exists(at, error); at = at.parent_path())
        missing.push_back(at);
    error.clear();
    for (auto at = missing.rbegin(); !error && at != missing.rend(); ++at)
        if (fs::create_directory(*at, error)) made_parents_.insert(made_parents_.begin(), *at);
}

void UnfinishedFolder::remove_made_parents() const {
    std::error_code ignored;
    for (const fs::path& parent : made_parents_) fs::remove(parent, ignored);  // others may have put something there
}

UnfinishedFolder::~UnfinishedFolder() {
    if (!released_) {
        remove_quietly(path_);
        remove_made_parents();
    }
    if (lock_ >= 0) close(lock_);
}

void UnfinishedFolder::sync() const {
    if (within_unfinished_folder(path_)) return;
    std::error_code error;
    for (fs::recursive_directory_iterator at(path_, error), end; !error && at != end; at.increment(error))
        if (at->is_directory() || at->is_regular_file()) sync_to_disk(at->path());
    if (error) throw_unwritable(path_, error.value());
    sync_to_disk(path_);
}

void UnfinishedFolder::release() {
    sync_to_disk(or_here(path_.parent_path()));
    for (const fs::path& parent : made_parents_) sync_to_disk(or_here(parent.parent_path()));
    remove_quietly(path_);
    released_ = true;
}

AtomicFolder::AtomicFolder(fs::path target, Existing existing)
    : target_(folder_name(std::move(target))),
      work_(target_.parent_path(), target_.filename().string()),
      existing_(may_replace_folder(target_) ? Existing::replace : existing) {
    refuse_existing("exists already; remove it or choose another name");
}

void AtomicFolder::refuse_existing(const char* what) const {
    std::error_code error;
    if (existing_ == Existing::refuse && fs::exists(fs::symlink_status(target_, error)))
        throw UserError(fmt::format("{} {}", target_.string(), what));
}

void AtomicFolder::commit() {
    mark_output(path(), target_);
    work_.sync();
    exchange();
    work_.release();  // and the earlier one goes
}

void AtomicFolder::exchange() {
    const int error =
        rename_or_exchange(path(), target_, [this] { refuse_existing("appeared meanwhile; choose another name"); });
    if (unsupported(error)) return rename_twice();
    if (error) throw_unwritable(target_, error);
}

void AtomicFolder::rename_twice() {
    while (true) {
        refuse_existing("appeared meanwhile; choose another name");
        const fs::path old = temporary_name(target_.parent_path(), target_.filename().string(), replaced_prefix);
        const int lock = lock_path(target_);  // others shall see that its replacement is under way
        const int parted = plain_rename(target_, old);
        int error = parted == ENOENT ? 0 : parted;
        if (!error) error = plain_rename(path(), target_);
        const bool another_was_faster = error == ENOTEMPTY || error == EEXIST;
        if (error && !another_was_faster && !parted) plain_rename(old, target_);  // the earlier output survives
        if (lock >= 0) close(lock);
        if (error && !another_was_faster) throw_unwritable(target_, error);
        if (!parted) remove_quietly(old);
        if (!error) return;
    }
}

AtomicFiles::AtomicFiles(fs::path folder) : folder_(std::move(folder)), work_(folder_, "") {}

void AtomicFiles::commit() {
    mark_output(path(), folder_);
    std::vector<fs::path> names;
    for (const fs::directory_entry& entry : fs::directory_iterator(path())) {
        names.push_back(entry.path().filename());
        file_name(folder_ / names.back());  // a folder in the way shows before the first file has its name
    }
    std::ranges::partition(names, [](const fs::path& name) { return name != made_by_name; });  // that comes last
    work_.sync();
    place(names);
    work_.release();
}

void AtomicFiles::place(const std::vector<fs::path>& names) {
    for (size_t i = 0; i < names.size(); ++i) {
        const fs::path from = path() / names[i], to = folder_ / names[i];
        int error = rename_or_exchange(from, to, [] {});
        if (unsupported(error)) error = plain_rename(from, to);
        if (!error) continue;
        while (i-- > 0) take_back(folder_ / names[i], path() / names[i]);
        throw_unwritable(to, error);
    }
}

}  // namespace radiafit

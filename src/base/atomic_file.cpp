#include "base/atomic_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <string>
#include <system_error>

#include "base/error.h"

namespace radiafit {
namespace fs = std::filesystem;
namespace {

[[noreturn]] void fail(const fs::path& path, const std::string& reason) {
    throw UserError(fmt::format("cannot write {}: {}; choose a writable folder", path.string(), reason));
}

constexpr std::string_view unfinished = ".tmp", replaced = ".old";

/// A name beside `path` that no other process or thread uses, hidden, with the same extension.
fs::path temporary_beside(const fs::path& path, std::string_view prefix = unfinished) {
    static std::atomic<unsigned> counter{0};
    return path.parent_path() / fmt::format("{}-{}-{}-{}", prefix, getpid(), counter++, path.filename().string());
}

/// The process that made this name by temporary_beside(target, prefix); 0 if none did.
pid_t maker_of(std::string_view name, const fs::path& target, std::string_view prefix) {
    const auto take = [&](std::string_view text) {
        const bool there = name.starts_with(text);
        if (there) name.remove_prefix(text.size());
        return there;
    };
    const auto take_number = [&](auto& number) {
        const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), number);
        name.remove_prefix(size_t(end - name.data()));
        return error == std::errc{};
    };
    pid_t process = 0;
    unsigned count = 0;
    const bool ours = take(prefix) && take("-") && take_number(process) && take("-") && take_number(count) &&
                      take("-") && name == target.filename().string();
    return ours && process > 0 ? process : 0;
}

/// Held until it is closed, or its process dies. -1: somebody holds it, or this file system has no locks.
int lock_folder(const fs::path& folder) {
    const int file = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
    if (file >= 0 && flock(file, LOCK_EX | LOCK_NB) == 0) return file;
    if (file >= 0) close(file);
    return -1;
}

/// What processes that were killed left of `target`. The lock tells one that is at work elsewhere (another container,
/// say) from one that is gone; the process's number, one that has not locked its folder yet. A replaced folder stays
/// while there is no other.
void remove_leftovers(const fs::path& target) {
    std::error_code error;
    std::vector<fs::path> leftovers;
    const bool stands = fs::exists(target, error);
    const fs::path parent = target.has_parent_path() ? target.parent_path() : fs::path(".");
    for (fs::directory_iterator at(parent, error), end; !error && at != end; at.increment(error)) {
        const std::string name = at->path().filename().string();
        pid_t process = maker_of(name, target, unfinished);
        if (process == 0 && stands) process = maker_of(name, target, replaced);
        if (process > 0 && kill(process, 0) != 0 && errno == ESRCH) leftovers.push_back(at->path());
    }
    for (const fs::path& leftover : leftovers) {
        const int lock = lock_folder(leftover);
        if (lock < 0) continue;
        fs::remove_all(leftover, error);
        close(lock);
    }
}

std::string last_error() { return std::generic_category().message(errno); }

/// "results/" and "results" are the same place, but only one of them has a file name.
fs::path without_trailing_slash(fs::path path) {
    path = path.lexically_normal();
    return path.has_filename() ? path : path.parent_path();
}

void sync_to_disk(const fs::path& path, const fs::path& shown) {
    const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (file < 0) fail(shown, last_error());
    const bool synced = fsync(file) == 0;
    const std::string reason = synced ? "" : last_error();
    close(file);
    if (!synced) fail(shown, reason);
}

}  // namespace

AtomicFile::AtomicFile(fs::path path) : path_(std::move(path)), temporary_(temporary_beside(path_)) {
    if (!path_.has_filename()) fail(path_, "it names a folder");
    std::error_code error;
    if (fs::is_directory(path_, error)) fail(path_, "it is a folder");
}

AtomicFile::~AtomicFile() {
    if (committed_) return;
    if (stream_.is_open()) stream_.close();
    std::error_code ignored;
    fs::remove(temporary_, ignored);
}

std::ofstream& AtomicFile::stream() {
    if (!stream_.is_open()) {
        errno = 0;
        stream_.open(temporary_, std::ios::binary | std::ios::trunc);
        if (!stream_) fail(path_, last_error());
    }
    return stream_;
}

void AtomicFile::commit(bool durable) {
    if (stream_.is_open()) {
        errno = 0;
        const bool whole = static_cast<bool>(stream_);
        stream_.close();
        if (!whole || !stream_) fail(path_, errno != 0 ? last_error() : "the disk took only a part of it");
    }
    if (durable) sync_to_disk(temporary_, path_);
    std::error_code error;
    fs::rename(temporary_, path_, error);
    if (error) fail(path_, error.message());
    committed_ = true;
}

void write_file(const fs::path& path, std::string_view text) {
    AtomicFile file(path);
    file.stream() << text;
    file.commit();
}

AtomicFolder::AtomicFolder(fs::path target, Existing existing)
    : target_(without_trailing_slash(std::move(target))), temporary_(temporary_beside(target_)), existing_(existing) {
    std::error_code error;
    if (fs::exists(target_, error) && existing_ == Existing::refuse)
        throw UserError(fmt::format("{} exists already; remove it or choose another name", target_.string()));
    for (fs::path parent = temporary_.parent_path(); !parent.empty() && !fs::exists(parent, error);
         parent = parent.parent_path())
        made_parents_.push_back(parent);
    remove_leftovers(target_);
    fs::create_directories(temporary_, error);
    if (error) fail(target_, error.message());
    lock_ = lock_folder(temporary_);
}

AtomicFolder::~AtomicFolder() {
    std::error_code ignored;
    if (!committed_) {
        fs::remove_all(temporary_, ignored);
        for (const fs::path& parent : made_parents_)
            if (!fs::remove(parent, ignored)) break;  // others have put something there
    }
    if (lock_ >= 0) close(lock_);
}

void AtomicFolder::commit() {
    std::error_code error;
    fs::path old;
    if (fs::exists(target_, error)) {
        if (existing_ == Existing::refuse)
            throw UserError(fmt::format("{} appeared meanwhile; choose another name", target_.string()));
        old = temporary_beside(target_, replaced);
        fs::rename(target_, old, error);
        if (error) fail(target_, error.message());
    }
    fs::rename(temporary_, target_, error);
    if (error) {
        std::error_code ignored;
        if (!old.empty()) fs::rename(old, target_, ignored);  // the earlier output survives a failure
        fail(target_, error.message());
    }
    committed_ = true;
    if (!old.empty()) fs::remove_all(old, error);
}

}  // namespace radiafit

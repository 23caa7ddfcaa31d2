#include "base/file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <system_error>
#include <utility>

#include "base/error.h"
#include "base/temporary_name.h"

namespace radiafit {
namespace {

constexpr size_t buffer_bytes = size_t(1) << 20;

std::string last_error() { return std::generic_category().message(errno); }

const char* cure_of(int error) {
    if (error == ENOSPC || error == EDQUOT || error == EFBIG) return "make room or choose another disk";
    if (error == ENAMETOOLONG) return "choose a shorter name";
    return "choose a writable folder";
}

}  // namespace

void throw_unwritable(const std::filesystem::path& path, int error) {
    const std::filesystem::path name = final_path(path);
    throw UserError(fmt::format("cannot write {}: {}; {}", name.empty() ? "into this folder" : name.string(),
                                std::generic_category().message(error), cure_of(error)));
}

InputFile::InputFile(std::filesystem::path path)
    : path_(std::move(path)), file_(open(path_.c_str(), O_RDONLY | O_CLOEXEC)) {
    if (file_ < 0 && errno == EACCES)
        throw UserError(fmt::format("{}: {}; check its permissions", path_.string(), last_error()));
    if (file_ < 0) throw SystemError(fmt::format("open({}): {}", path_.string(), last_error()));
}

InputFile::~InputFile() {
    if (file_ >= 0) ::close(file_);
}

void InputFile::read(void* to, uint64_t offset, uint64_t bytes) const {
    auto* at = static_cast<uint8_t*>(to);
    while (bytes > 0) {
        const ssize_t got = pread(file_, at, bytes, off_t(offset));
        if (got < 0 && errno == EINTR) continue;
        if (got < 0)
            throw SystemError(
                fmt::format("pread({}, {} bytes at {}): {}", path_.string(), bytes, offset, last_error()));
        if (got == 0)
            throw UserError(
                fmt::format("{}: ends at byte {}, before what it is said to hold: if it was replaced "
                            "meanwhile, run again, else make it anew",
                            final_path(path_).string(), offset));
        at += got;
        offset += uint64_t(got);
        bytes -= uint64_t(got);
    }
}

uint64_t InputFile::size() const {
    struct stat status;
    if (fstat(file_, &status) != 0) throw SystemError(fmt::format("fstat({}): {}", path_.string(), last_error()));
    return uint64_t(status.st_size);
}

void InputFile::no_readahead() const { posix_fadvise(file_, 0, 0, POSIX_FADV_RANDOM); }

void InputFile::forget(uint64_t offset, uint64_t bytes) const {
    posix_fadvise(file_, off_t(offset), off_t(bytes), POSIX_FADV_DONTNEED);  // advice: cached_share() shows the effect
}

OutputFile::OutputFile(std::filesystem::path path)
    : path_(std::move(path)), file_(open(path_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666)) {
    if (file_ < 0) throw_unwritable(path_, errno);
    buffer_.reserve(buffer_bytes);
}

OutputFile::~OutputFile() {
    if (file_ >= 0) ::close(file_);
}

void OutputFile::write(const void* from, size_t bytes) {
    const auto* at = static_cast<const uint8_t*>(from);
    bytes_ += bytes;
    if (buffer_.size() + bytes > buffer_bytes) {
        flush(buffer_.data(), buffer_.size());
        buffer_.clear();
    }
    if (bytes >= buffer_bytes) return flush(at, bytes);
    buffer_.insert(buffer_.end(), at, at + bytes);
}

void OutputFile::flush(const uint8_t* from, size_t bytes) {
    while (bytes > 0) {
        const ssize_t put = ::write(file_, from, bytes);
        if (put < 0 && errno == EINTR) continue;
        if (put <= 0) throw_unwritable(path_, put == 0 ? ENOSPC : errno);
        from += put;
        bytes -= size_t(put);
    }
}

void OutputFile::close() {
    flush(buffer_.data(), buffer_.size());
    buffer_.clear();
    if (::close(std::exchange(file_, -1)) != 0) throw_unwritable(path_, errno);
}

void OutputFile::lock() const { flock(file_, LOCK_EX | LOCK_NB); }

void sync_to_disk(const std::filesystem::path& path) {
    const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC);
    int error = file < 0 || fsync(file) != 0 ? errno : 0;
    if (file >= 0) ::close(file);
    if (error == EINVAL || error == ENOSYS || error == EOPNOTSUPP || error == EROFS || error == EACCES) error = 0;
    if (error) throw_unwritable(path, error);
}

double cached_share(const std::filesystem::path& path) {
    const InputFile file(path);
    const uint64_t bytes = file.size();
    if (bytes == 0) return 0;
    void* map = mmap(nullptr, bytes, PROT_READ, MAP_SHARED, file.descriptor(), 0);
    if (map == MAP_FAILED) throw SystemError(fmt::format("mmap({}): {}", path.string(), last_error()));
    const uint64_t page = uint64_t(sysconf(_SC_PAGESIZE));
    std::vector<unsigned char> resident((bytes + page - 1) / page);
    const bool known = mincore(map, bytes, resident.data()) == 0;
    const std::string reason = known ? "" : last_error();
    munmap(map, bytes);
    if (!known) throw SystemError(fmt::format("mincore({}): {}", path.string(), reason));
    const auto count = std::count_if(resident.begin(), resident.end(), [](unsigned char r) { return r & 1; });
    return double(count) / double(resident.size());
}

void drop_from_cache(const std::filesystem::path& path) {
    const InputFile file(path);
    fdatasync(file.descriptor());  // dirty pages stay
    file.forget(0, 0);             // 0 bytes: to the end
}

}  // namespace radiafit

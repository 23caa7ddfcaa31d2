#include "base/read_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "base/error.h"

namespace radiafit {
namespace {

constexpr uint64_t largest_file = uint64_t(1) << 32;

class Descriptor {
public:
    /// Without O_NONBLOCK, a pipe would keep us until somebody writes into it.
    explicit Descriptor(const std::filesystem::path& file)
        : number_(open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY)) {}
    ~Descriptor() {
        if (number_ >= 0) close(number_);
    }
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    int number() const { return number_; }

private:
    int number_;
};

/// Returns the file's size.
uint64_t check_status(const Descriptor& opened, const std::filesystem::path& file, const std::string& what) {
    const auto fail = [&](const std::string& why, const char* cure) {
        throw UserError(fmt::format("{}: cannot read this {}: {}: {}", file.string(), what, why, cure));
    };
    struct stat status = {};
    if (opened.number() < 0 || fstat(opened.number(), &status) != 0) {
        if (errno == ENOENT || errno == ENOTDIR)
            throw UserError(fmt::format("{}: no such {}: check the path", file.string(), what));
        fail(std::generic_category().message(errno), errno == EACCES ? "check its permissions" : "check the path");
    }
    if (S_ISDIR(status.st_mode)) fail("it is a folder", "give the file");
    if (!S_ISREG(status.st_mode)) fail("it is a pipe or a device", "give a regular file");
    if (uint64_t(status.st_size) > largest_file)
        fail(fmt::format("it has {} bytes, more than {}", status.st_size, largest_file), "give a smaller one");
    return uint64_t(status.st_size);
}

std::filesystem::file_status look_at(const std::filesystem::path& path) {
    std::error_code error;
    const std::filesystem::file_status status = std::filesystem::status(path, error);
    // A name too long for any file is one of none.
    if (status.type() == std::filesystem::file_type::none && error != std::errc::filename_too_long)
        throw UserError(
            fmt::format("{}: cannot look there: {}: {}", path.string(), error.message(),
                        error == std::errc::permission_denied ? "check its permissions" : "check the path"));
    return status;
}

}  // namespace

bool path_exists(const std::filesystem::path& path) {
    const std::filesystem::file_status status = look_at(path);
    return std::filesystem::status_known(status) && std::filesystem::exists(status);
}

bool folder_exists(const std::filesystem::path& path) { return std::filesystem::is_directory(look_at(path)); }

std::string read_file(const std::filesystem::path& file, const std::string& what) {
    const Descriptor opened(file);
    std::string bytes(check_status(opened, file, what), '\0');
    size_t done = 0;
    while (done < bytes.size()) {
        const ssize_t got = read(opened.number(), bytes.data() + done, bytes.size() - done);
        if (got < 0 && errno == EINTR) continue;
        if (got < 0)
            throw UserError(fmt::format("{}: cannot read this {}: {}: copy it again", file.string(), what,
                                        std::generic_category().message(errno)));
        if (got == 0) break;  // it was cut meanwhile: whoever understands the content will notice
        done += size_t(got);
    }
    bytes.resize(done);
    return bytes;
}

void check_readable(const std::filesystem::path& file, const std::string& what) {
    check_status(Descriptor(file), file, what);
}

}  // namespace radiafit

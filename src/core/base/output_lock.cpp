#include "base/output_lock.h"

#include <fmt/format.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <system_error>

#include "base/error.h"
#include "base/hash.h"
#include "base/leftovers.h"

namespace radiafit {

std::string place_of(const std::filesystem::path& output) {
    std::error_code error;
    return std::filesystem::weakly_canonical(std::filesystem::absolute(follow_links(output), error), error).string();
}

OutputLock::OutputLock(const std::filesystem::path& output) : socket_(socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    const std::string place = place_of(output);
    const std::string name = fmt::format("radiafit-output-{:016x}", hash_byte_by_byte(place.data(), place.size()));
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::ranges::copy(name, address.sun_path + 1);  // behind a zero: abstract
    const auto size = socklen_t(offsetof(sockaddr_un, sun_path) + 1 + name.size());
    if (socket_ < 0 || bind(socket_, reinterpret_cast<const sockaddr*>(&address), size) == 0 || errno != EADDRINUSE)
        return;
    close(socket_);
    throw UserError(
        fmt::format("{}: another run is writing it; wait for that to end, or choose another name", output.string()));
}

OutputLock::~OutputLock() {
    if (socket_ >= 0) close(socket_);
}

}  // namespace radiafit

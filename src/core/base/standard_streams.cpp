#include "base/standard_streams.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>

#include "base/error.h"

namespace radiafit {

void prepare_standard_streams() {
    for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
        if (fcntl(stream, F_GETFD) >= 0 || errno != EBADF) continue;
        // The lowest free number is this stream's. Opened the wrong way round: using it fails, as on a closed one.
        open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY);
    }
    std::signal(SIGPIPE, SIG_IGN);
    std::signal(SIGXFSZ, SIG_IGN);
}

void write_to_stderr(std::string_view text) noexcept {
    while (!text.empty()) {
        const ssize_t put = write(STDERR_FILENO, text.data(), text.size());
        if (put < 0 && errno == EINTR) continue;
        if (put <= 0) return;
        text.remove_prefix(size_t(put));
    }
}

bool standard_output_failed() { return std::ferror(stdout) != 0; }

std::string standard_output_failure() {
    return "standard output took only a part; make room, or keep the program running that reads it";
}

void finish_standard_output() {
    if (std::fflush(stdout) != 0 || standard_output_failed()) throw SystemError(standard_output_failure());
}

}  // namespace radiafit

#include "base/interrupt.h"

#include <fmt/format.h>
#include <signal.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdlib>

#include "base/log.h"
#include "base/standard_streams.h"

namespace radiafit {
namespace {

std::atomic<int> came{0};
static_assert(std::atomic<int>::is_always_lock_free);

void end_by_default(int number) {
    struct sigaction action {};
    action.sa_handler = SIG_DFL;
    sigaction(number, &action, nullptr);
}

void note_signal(int number) {
    const int error = errno;  // the code that is interrupted may be about to look at it
    came = number;
    for (const int caught : {SIGINT, SIGTERM}) end_by_default(caught);
    if (!quiet()) {
        if (isatty(STDERR_FILENO)) write_to_stderr("\n");  // behind a bar, or ^C
        write_to_stderr("ends after the current step; once more ends at once\n");
    }
    errno = error;
}

}  // namespace

void catch_interrupts() {
    for (const int number : {SIGINT, SIGTERM}) {
        struct sigaction action {};
        if (sigaction(number, nullptr, &action) != 0 || action.sa_handler == SIG_IGN) continue;
        action = {};
        action.sa_handler = note_signal;
        action.sa_flags = SA_RESTART;
        sigaction(number, &action, nullptr);
    }
}

void throw_if_interrupted() {
    if (const int number = came.load(std::memory_order_relaxed)) throw Interrupted{number, {}};
}

void end_interrupted(const std::string& program, const Interrupted& interrupted) {
    const char* name = interrupted.signal == SIGINT ? "SIGINT" : "SIGTERM";
    log_error(program, fmt::format("stopped by {}{}{}", name, interrupted.note.empty() ? "" : "; ", interrupted.note));
    end_by_default(interrupted.signal);
    raise(interrupted.signal);
    std::_Exit(128 + interrupted.signal);
}

}  // namespace radiafit

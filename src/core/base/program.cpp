#include "base/program.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <spawn.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <utility>

#include "base/error.h"
#include "base/interrupt.h"

namespace radiafit {
namespace {

class Pipe {
public:
    Pipe() {
        if (pipe2(ends_, O_CLOEXEC) != 0) throw SystemError("pipe2 failed: " + std::generic_category().message(errno));
    }
    ~Pipe() {
        close_writing();
        close(ends_[0]);
    }
    Pipe(const Pipe&) = delete;
    Pipe& operator=(const Pipe&) = delete;

    int reading() const { return ends_[0]; }
    int writing() const { return ends_[1]; }
    void close_writing() {
        if (ends_[1] >= 0) close(std::exchange(ends_[1], -1));
    }

private:
    int ends_[2];
};

/// Appends what can be read now; returns whether there may be more.
bool take_some(int file, std::string& text) {
    char buffer[1 << 16];
    const ssize_t count = read(file, buffer, sizeof buffer);
    if (count > 0) text.append(buffer, size_t(count));
    return count > 0 || (count < 0 && errno == EINTR);
}

/// Both at once, since a program waits while one of its pipes is full.
void take_all(const Pipe& output, const Pipe& errors, Ended& ended) {
    pollfd files[] = {{output.reading(), POLLIN, 0}, {errors.reading(), POLLIN, 0}};
    std::string* texts[] = {&ended.output, &ended.message};
    while (files[0].fd >= 0 || files[1].fd >= 0) {
        if (poll(files, 2, -1) < 0) continue;  // interrupted
        for (size_t i = 0; i < 2; ++i)
            if (files[i].fd >= 0 && files[i].revents && !take_some(files[i].fd, *texts[i])) files[i].fd = -1;
    }
}

void write_all(int file, std::string_view text) {
    while (!text.empty()) {
        const ssize_t count = write(file, text.data(), text.size());
        if (count < 0 && errno != EINTR) return;
        if (count > 0) text.remove_prefix(size_t(count));
    }
}

int status_of(int status) { return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status); }

int end_status(pid_t child) {
    int status = 0;
    while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    return status_of(status);
}

/// Starts a program found on PATH, and destroys the actions. Returns 0, or the error's number.
int spawn(std::vector<std::string>& command, posix_spawn_file_actions_t& actions, pid_t& child) {
    std::vector<char*> arguments;
    for (std::string& argument : command) arguments.push_back(argument.data());
    arguments.push_back(nullptr);
    const int failed = posix_spawnp(&child, arguments[0], &actions, nullptr, arguments.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    return failed;
}

[[noreturn]] void throw_not_started(const std::string& program, int error) {
    throw SystemError(fmt::format("posix_spawnp {} failed: {}", program, std::generic_category().message(error)));
}

}  // namespace

Ended run_program(std::vector<std::string> command) {
    Pipe output, errors;
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_adddup2(&actions, output.writing(), STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&actions, errors.writing(), STDERR_FILENO);
    pid_t child = 0;
    const int failed = spawn(command, actions, child);
    Ended ended;
    if (failed == ENOENT) return ended;
    if (failed != 0) throw_not_started(command[0], failed);
    output.close_writing();
    errors.close_writing();
    take_all(output, errors, ended);
    ended.status = end_status(child);
    return ended;
}

RunningProgram::RunningProgram(std::vector<std::string> command) : name_(command[0]) {
    int ends[2];  // one socket each way: a write to a program that has ended raises no signal
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
        throw SystemError("socketpair failed: " + std::generic_category().message(errno));
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
    pid_t child = 0;
    const int failed = spawn(command, actions, child);
    close(ends[1]);
    if (failed != 0) {
        close(ends[0]);
        throw_not_started(command[0], failed);
    }
    socket_ = ends[0];
    process_ = child;
}

RunningProgram::~RunningProgram() {
    close(socket_);
    end_status(process_);
}

void RunningProgram::write(const void* bytes, size_t size) {
    for (const char* at = static_cast<const char*>(bytes); size > 0;) {
        const ssize_t count = send(socket_, at, size, MSG_NOSIGNAL);
        throw_if_interrupted();
        if (count < 0 && errno != EINTR) throw SystemError(name_ + " ended before it was told all");
        if (count > 0) at += count, size -= size_t(count);
    }
}

void RunningProgram::read(void* bytes, size_t size) {
    for (char* at = static_cast<char*>(bytes); size > 0;) {
        const ssize_t count = recv(socket_, at, size, 0);
        throw_if_interrupted();
        if (count == 0 || (count < 0 && errno != EINTR)) throw SystemError(name_ + " ended before it answered");
        if (count > 0) at += count, size -= size_t(count);
    }
}

int run_in_front(std::vector<std::string> command, const std::filesystem::path& folder, unsigned seconds) {
    std::vector<char*> arguments;
    for (std::string& argument : command) arguments.push_back(argument.data());
    arguments.push_back(nullptr);
    const pid_t child = fork();
    if (child < 0) throw SystemError("fork failed: " + std::generic_category().message(errno));
    if (child == 0) {
        alarm(seconds);                    // which the program keeps, as it does
        prctl(PR_SET_PDEATHSIG, SIGTERM);  // this: it ends with us
        if (chdir(folder.c_str()) == 0) execvp(arguments[0], arguments.data());
        _exit(127);
    }
    for (bool passed_on = false;; usleep(50'000)) {
        int status = 0;
        if (waitpid(child, &status, WNOHANG) == child) return status_of(status);
        if (passed_on) continue;
        try {
            throw_if_interrupted();
        } catch (const Interrupted& interrupted) {
            if (interrupted.signal == SIGTERM) kill(child, SIGTERM);  // Ctrl-C reaches it as it does us
            passed_on = true;
        }
    }
}

Ended run_apart(const std::function<std::string()>& body, unsigned seconds) {
    Pipe output, errors;
    const pid_t child = fork();
    if (child < 0) throw SystemError("fork failed: " + std::generic_category().message(errno));
    if (child == 0) {
        const rlimit no_core_file{0, 0};
        setrlimit(RLIMIT_CORE, &no_core_file);
        alarm(seconds);
        dup2(errors.writing(), STDERR_FILENO);
        try {
            write_all(output.writing(), body());
        } catch (...) {
            _exit(1);
        }
        _exit(0);  // with none of the ends of this process's copy, such as unwritten output
    }
    output.close_writing();
    errors.close_writing();
    Ended ended;
    take_all(output, errors, ended);
    ended.status = end_status(child);
    return ended;
}

std::string single_line(const std::string& text) {
    std::string result;
    for (const char c : text) {
        if (c != '\n' && c != '\r')
            result += c;
        else if (!result.empty() && result.back() != ' ')
            result += ' ';
    }
    while (result.ends_with(' ')) result.pop_back();
    return result;
}

bool on_path(const std::string& program) {
    const char* path = std::getenv("PATH");
    std::string_view rest = path ? path : "/usr/local/bin:/usr/bin:/bin";
    while (true) {
        const size_t colon = rest.find(':');
        const std::filesystem::path file = std::filesystem::path(rest.substr(0, colon)) / program;
        std::error_code ignored;
        if (std::filesystem::is_regular_file(file, ignored) && access(file.c_str(), X_OK) == 0) return true;
        if (colon == std::string_view::npos) return false;
        rest.remove_prefix(colon + 1);
    }
}

}  // namespace radiafit

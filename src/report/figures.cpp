#include "report/figures.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <string_view>
#include <system_error>
#include <utility>

#include "base/atomic_file.h"
#include "base/error.h"

namespace radiafit {
namespace fs = std::filesystem;
namespace {

/// name='value' with quotes doubled, as gnuplot reads a single-quoted string.
std::string assignment(const std::string& name, const std::string& value) {
    std::string text = name + "='";
    for (const char c : value) {
        if (c == '\'') text += '\'';
        text += c;
    }
    return text + '\'';
}

struct Ended {
    int status = 127;  ///< 127: there is no such program
    std::string output, message;
};

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

/// Whether there may be more.
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

int end_status(pid_t child) {
    int status = 0;
    while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

/// Runs a program found on PATH with nothing on its standard input.
Ended run(std::vector<std::string> command) {
    Pipe output, errors;
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_adddup2(&actions, output.writing(), STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&actions, errors.writing(), STDERR_FILENO);
    std::vector<char*> arguments;
    for (std::string& argument : command) arguments.push_back(argument.data());
    arguments.push_back(nullptr);
    pid_t child = 0;
    const int failed = posix_spawnp(&child, arguments[0], &actions, nullptr, arguments.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    Ended ended;
    if (failed == ENOENT) return ended;
    if (failed != 0)
        throw SystemError(
            fmt::format("posix_spawnp {} failed: {}", command[0], std::generic_category().message(failed)));
    output.close_writing();
    errors.close_writing();
    take_all(output, errors, ended);
    ended.status = end_status(child);
    return ended;
}

/// On one line, since every error of ours is one.
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

/// A file that gnuplot was stopped in the middle of lacks its end.
bool whole(const std::string& image, const std::string& terminal) {
    if (terminal == "png") return image.ends_with(std::string_view("IEND\xae\x42\x60\x82"));
    return image.find_last_not_of(" \n") != std::string::npos &&
           std::string_view(image).substr(0, image.find_last_not_of(" \n") + 1).ends_with("</svg>");
}

/// The image's bytes. They come through a pipe: gnuplot says nothing of a file that the disk did not take whole.
std::string draw(const fs::path& script, const std::string& terminal,
                 const std::vector<std::pair<std::string, std::string>>& variables) {
    // Neither a terminal nor settings of the user's own.
    std::vector<std::string> command = {"env", "-u", "GNUTERM", "gnuplot", "-d"};
    const auto define = [&command](const std::string& name, const std::string& value) {
        command.insert(command.end(), {"-e", assignment(name, value)});
    };
    for (const auto& [name, value] : variables) define(name, value);
    define("terminal", terminal);
    define("output", "/dev/stdout");
    command.push_back(script.string());
    Ended ended = run(command);
    if (ended.status == 127)
        throw UserError(
            "gnuplot is missing, so no figure can be drawn; install gnuplot-nox (scripts/install-packages.sh does)");
    if (ended.status != 0)
        throw SystemError(fmt::format("gnuplot {} failed with status {}: {}", script.string(), ended.status,
                                      single_line(ended.message)));
    if (!whole(ended.output, terminal))
        throw SystemError(fmt::format("gnuplot {} drew {}: {}", script.string(),
                                      ended.output.empty() ? "nothing" : "only a part", single_line(ended.message)));
    return std::move(ended.output);
}

}  // namespace

void draw_figure(const fs::path& script, const fs::path& stem,
                 const std::vector<std::pair<std::string, std::string>>& variables) {
    if (!fs::is_regular_file(script))
        throw UserError(fmt::format("{}: no such script; check the path", script.string()));
    AtomicFiles files(stem.parent_path());
    for (const char* terminal : {"svg", "png"})
        write_file(files.path() / (stem.filename().string() + "." + terminal), draw(script, terminal, variables));
    files.commit();
}

}  // namespace radiafit

#include "report/figures.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

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
    int status;           ///< 127: there is no such program
    std::string message;  ///< its standard error
};

/// Runs a program found on PATH with nothing on its standard input, and gathers what it says.
Ended run(std::vector<std::string> command) {
    int pipe_ends[2];
    if (pipe2(pipe_ends, O_CLOEXEC) != 0) throw SystemError("pipe2 failed: " + std::generic_category().message(errno));
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_adddup2(&actions, pipe_ends[1], STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&actions, pipe_ends[1], STDERR_FILENO);
    std::vector<char*> arguments;
    for (std::string& argument : command) arguments.push_back(argument.data());
    arguments.push_back(nullptr);
    pid_t child = 0;
    const int failed = posix_spawnp(&child, arguments[0], &actions, nullptr, arguments.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    close(pipe_ends[1]);
    Ended ended{.status = 127, .message = {}};
    char buffer[4096];
    for (ssize_t count; failed == 0;) {
        count = read(pipe_ends[0], buffer, sizeof buffer);
        if (count > 0) ended.message.append(buffer, static_cast<size_t>(count));
        if (count == 0 || (count < 0 && errno != EINTR)) break;
    }
    close(pipe_ends[0]);
    if (failed == ENOENT) return ended;
    if (failed != 0)
        throw SystemError(
            fmt::format("posix_spawnp {} failed: {}", command[0], std::generic_category().message(failed)));
    int status = 0;
    while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    ended.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
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

void draw(const fs::path& script, const fs::path& output, const std::string& terminal,
          const std::vector<std::pair<std::string, std::string>>& variables) {
    AtomicFile file(output);
    file.stream();  // fails here, with our words, where gnuplot could not write
    std::vector<std::string> command = {"gnuplot"};
    const auto define = [&command](const std::string& name, const std::string& value) {
        command.insert(command.end(), {"-e", assignment(name, value)});
    };
    for (const auto& [name, value] : variables) define(name, value);
    define("terminal", terminal);
    define("output", file.temporary_path().string());
    command.push_back(script.string());
    const Ended ended = run(command);
    if (ended.status == 127)
        throw UserError(
            "gnuplot is missing, so no figure can be drawn; install gnuplot-nox (scripts/install-packages.sh does)");
    if (ended.status != 0)
        throw SystemError(fmt::format("gnuplot {} failed with status {}: {}", script.string(), ended.status,
                                      single_line(ended.message)));
    if (fs::file_size(file.temporary_path()) == 0)
        throw SystemError(fmt::format("gnuplot {} drew nothing: {}", script.string(), single_line(ended.message)));
    file.commit();
}

}  // namespace

void draw_figure(const fs::path& script, const fs::path& stem,
                 const std::vector<std::pair<std::string, std::string>>& variables) {
    if (!fs::is_regular_file(script))
        throw UserError(fmt::format("{}: no such script; check the path", script.string()));
    for (const char* terminal : {"svg", "png"}) draw(script, stem.string() + "." + terminal, terminal, variables);
}

}  // namespace radiafit

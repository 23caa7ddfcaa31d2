#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

/// Other processes: programs, such as gnuplot, and what may crash.
namespace radiafit {

/// What a program that has ended left behind.
struct Ended {
    int status = 127;             ///< its exit status; 128 and the signal that ended it; 127: there is no such program
    std::string output, message;  ///< what it wrote to standard output and to standard error
};

/// Runs a program found on PATH, with its arguments behind it and nothing on its standard input, to its end. Throws
/// SystemError where it cannot be started.
Ended run_program(std::vector<std::string> command);

/// A program found on PATH that runs beside this one and talks with it: what is written here is its standard input, and
/// what it writes to its standard output is read here; what it says of errors is not seen.
class RunningProgram {
public:
    /// Throws SystemError where it cannot be started.
    explicit RunningProgram(std::vector<std::string> command);
    ~RunningProgram();  ///< ends its input, and waits for it
    RunningProgram(const RunningProgram&) = delete;
    RunningProgram& operator=(const RunningProgram&) = delete;

    // Whole or not at all: SystemError where the program has ended.
    void write(const void* bytes, size_t size);
    void read(void* bytes, size_t size);

private:
    std::string name_;
    int socket_ = -1, process_ = 0;
};

/// Runs a program in a folder as a shell does: what it writes is seen, Ctrl-C reaches it. After so many seconds SIGALRM
/// ends it. The status as in Ended.
int run_in_front(std::vector<std::string> command, const std::filesystem::path& folder, unsigned seconds);

/// Runs `body` in a child process, a copy of this one that ends with it: nothing that happens there, a crash included,
/// happens here. What it returns is Ended::output; where it throws, Ended::status is 1. It must start no
/// threads; after so many seconds SIGALRM ends it. Throws SystemError where no process can be started.
Ended run_apart(const std::function<std::string()>& body, unsigned seconds);

/// Whether PATH has a program of this name.
bool on_path(const std::string& program);

/// On one line, since every error of ours is one.
std::string single_line(const std::string& text);

}  // namespace radiafit

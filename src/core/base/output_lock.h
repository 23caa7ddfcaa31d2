#pragma once
#include <filesystem>
#include <string>

namespace radiafit {

/// What an output is known by, however its name is written and whatever links lead to it.
std::string place_of(const std::filesystem::path& output);

/// One run of a machine at a time writes an output: a name that the kernel keeps as long as the run lives, and no
/// longer, however it ends (of an abstract socket, unix(7); it is of no file).
class OutputLock {
public:
    /// Throws UserError where another run holds it. Where there are no such names, there is no lock.
    explicit OutputLock(const std::filesystem::path& output);
    ~OutputLock();
    OutputLock(const OutputLock&) = delete;
    OutputLock& operator=(const OutputLock&) = delete;

private:
    int socket_;
};

}  // namespace radiafit

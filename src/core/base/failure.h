#pragma once
#include <exception>
#include <string>

/// What a program says when it gives up.
namespace radiafit {

struct Failure {
    int status;        ///< of the program: 1 the machine failed, 2 the user's mistake
    std::string line;  ///< for log_error()
};
/// Of an exception. Paths that the system refuses (a loop of links, no permission, too long a name) are the user's to
/// mend, whoever looked at them.
Failure describe(const std::exception& error);

}  // namespace radiafit

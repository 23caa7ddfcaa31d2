#pragma once
#include <exception>
#include <string>

/// What a program says when it gives up.
namespace radiafit {

struct Failure {
    int status;        ///< of the program: 1 the machine failed, 2 the user's mistake
    std::string line;  ///< for log_error()
};
/// The failure that an exception means. A path that the system refuses (a loop of links, no permission, too long a
/// name) is the user's mistake, whoever looked at it.
Failure describe(const std::exception& error);

}  // namespace radiafit

#pragma once
#include <stdexcept>
#include <string>

/// The three kinds of failure (two of them thrown; numerics are a status per problem, see model/status.h).
namespace radiafit {

/// A mistake of the user's: one line that names the file and the cure. Programs print it and exit with status 2.
class UserError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// GL or I/O failed: the message quotes the call. Programs print it and exit with status 1.
class SystemError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

}  // namespace radiafit

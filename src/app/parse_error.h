#pragma once
#include <CLI/CLI.hpp>
#include <string>

namespace radiafit {

/// One line for a command line that could not be parsed: what is wrong, the nearest name that exists, and the cure.
std::string explain(const CLI::App& app, const CLI::ParseError& error);

}  // namespace radiafit

#pragma once
#include <functional>
#include <map>
#include <string>
#include <string_view>

/// How messages name what a user sets and calls. They come from layers that a program and a library share: one who runs
/// a program knows flags and commands, a caller of the library knows neither.
namespace radiafit {

/// Called once, first thing in a program whose user reads messages at the command line. `otherwise`: what this program
/// calls by another name than messages do, an option or a text that at_command_line() is given.
void name_options_by_flag(std::map<std::string, std::string, std::less<>> otherwise = {});

/// "'view-side'"; "--view-side" once name_options_by_flag() was called.
std::string option_name(std::string_view name);

/// `otherwise`; `typed` once name_options_by_flag() was called. For words with flags and commands in them:
/// at_command_line("see `radiafit devices`", "see list_devices()").
std::string at_command_line(std::string_view typed, std::string_view otherwise);

}  // namespace radiafit

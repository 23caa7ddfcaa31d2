#pragma once
#include <string>

#include "command_line/command_line.h"

/// Completions of a program's commands, options, and values that are names, for shells to read.
namespace radiafit::harness {

std::string bash_completion(const CommandDescription& program);
/// Bash's, which zsh's bashcompinit reads.
std::string zsh_completion(const CommandDescription& program);
std::string fish_completion(const CommandDescription& program);

}  // namespace radiafit::harness

#pragma once
#include <string>

#include "command_line/command_line.h"

namespace radiafit::harness {

/// The manual page of a program with its commands, in the language of man(7).
std::string man_page(const CommandDescription& program, const std::string& version);

}  // namespace radiafit::harness

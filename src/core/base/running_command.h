#pragma once
#include <string>

namespace radiafit {

/// The command that runs, such as "import colmap", which lines and bars of progress name before their task. Set before
/// threads are started; empty: they name the task alone.
void set_running_command(std::string words);

}  // namespace radiafit

#pragma once
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "base/rings.h"

/// Figures are gnuplot scripts over result rows.
namespace radiafit::harness {

/// Runs `script` twice and leaves STEM.svg and STEM.png, both or, after an error, what was there before.
/// The script sees the given string variables and two more: `terminal` ("svg" or "png") and `output` (a file to set as
/// output). Paths in variables should be absolute or relative to the working folder of this process.
/// Throws UserError if gnuplot is missing, the script can't be read or the output can't be written, SystemError with
/// gnuplot's message if the script fails or draws nothing.
void draw_figure(const std::filesystem::path& script, const std::filesystem::path& stem,
                 const std::vector<std::pair<std::string, std::string>>& variables);

}  // namespace radiafit::harness

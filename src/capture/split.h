#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace radiafit {

/// Which of the images (sorted by name) are held out: "none", "every:N" (the first of each N), or a file with one
/// image name per line (# comments). Throws UserError for another rule, a name that is not among the images, and a
/// rule that leaves nothing to fit.
std::vector<uint8_t> choose_held_out(const std::vector<std::string>& names, const std::string& rule);

}  // namespace radiafit
